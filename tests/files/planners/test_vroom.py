"""VROOM's JSON: what its skills, windows and tasks become, and what is left out or refused."""

import pytest
from pydantic_core import to_json

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, UnreadableFile
from service.requests.fleet import parse_fleet_request
from tests.files.test_examples import FOLDER, read
from tests.helpers.serving import LIMITS


@pytest.mark.parametrize("name", ["vroom.json", "vroom-skills.json", "vroom-shipments.json"])
def test_the_service_takes_what_is_read(name: str) -> None:
    request = parse_fleet_request(to_json(read(name).request), LIMITS)
    assert len(request.subject().rules.visits) == len(request.stops)


def test_vroom_s_skills_windows_and_breaks_are_read() -> None:
    reading = read("vroom-skills.json")
    _, first, second, third = reading.request["stops"]
    assert first["skills"] == ["1", "14"]
    assert first["windows"] == [[32400, 36000], [50400, 54000]]
    assert second["skills"] == ["2"]
    assert not third.keys() & {"skills", "window", "windows"}
    day, evening = reading.request["vehicles"]
    assert (day["id"], evening["id"]) == ("264", "264 (2)")
    assert day["max_stops"] == 3
    assert day["breaks"] == [{"window": [43200, 46800], "length": 1800}]
    notes = [note.text for note in reading.notes]
    assert "breaks of vehicles without exactly one time window were left out." not in notes
    for name in ("steps of vehicles", "priority of jobs"):
        assert f"{name} was not used: it is not supported for fleets." in notes
    assert (day["speed_factor"], "speed_factor" in evening) == (1.2, False)


def test_vroom_s_most_tasks_are_left_out_beside_shipments() -> None:
    reading = read("vroom-shipments.json")
    assert all(stop["skills"] == ["3"] for stop in reading.request["stops"][1:])
    sentence = "max_tasks of vehicles was left out: it is not supported beside shipments."
    assert sentence in [note.text for note in reading.notes]


VROOM = [
    ('"skills": [2], ', '"skills": {"a": 1}, ', "vehicles/1/skills must be a list of numbers"),
    ("[[32400, 36000], [50400, 54000]]", "[[7, 30, 7, 31]]", "jobs/0/time_windows/0 must be two"),
    ("[68400, 79200]", "[[68400, 79200]]", "vehicles/1/time_window must be two times in seconds"),
    ("[[32400, 36000], [50400, 54000]]", "9", "jobs/0/time_windows must be a list of windows"),
]


@pytest.mark.parametrize(("old", "new", "sentence"), VROOM)
def test_a_member_of_vroom_that_cannot_be_is_refused(old: str, new: str, sentence: str) -> None:
    text = (FOLDER / "vroom-skills.json").read_text()
    assert old in text
    with pytest.raises(UnreadableFile) as refused:
        read_files([NamedFile("vroom.json", text.replace(old, new).encode())], Bounds())
    assert sentence in str(refused.value)
