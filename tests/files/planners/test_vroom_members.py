"""Members of VROOM's JSON: each is honoured where a fleet can say it, or a note names it."""

import json
from typing import Any

import pytest
from pydantic_core import to_json

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, Reading, UnreadableFile
from service.kinds.parsing import parse_task
from service.requests.task import TaskSource
from tests.files.test_examples import ACTORS
from tests.helpers.serving import LIMITS

Members = dict[str, Any]
HOME, NEAR, FAR = [24.94, 60.17], [24.99, 60.17], [24.89, 60.17]
SECONDS = [[0, 1800, 900], [1800, 0, 600], [900, 600, 0]]
METRES = [[0, 20_000, 9000], [20_000, 0, 5000], [9000, 5000, 0]]
CARS = {"matrices": {"car": {"durations": SECONDS, "distances": METRES}}}


def problem(vehicle: Members | None = None, job: Members | None = None, **members: Any) -> Members:
    """A van, and two jobs: on the earth, or with indexes where there are matrices."""
    if {"matrices", "matrix"} & members.keys():
        at = [{"location_index": 1}, {"location_index": 2}]
        home = {"start_index": 0, "end_index": 0}
    else:
        at = [{"location": NEAR}, {"location": FAR}]
        home = {"start": HOME, "end": HOME}
    jobs = [{"id": number, **place, **(job or {})} for number, place in enumerate(at, 1)]
    vehicles = [{"id": number, **home, **(vehicle or {})} for number in (1, 2)]
    return {"vehicles": vehicles, "jobs": jobs, **members}


def of_second(vehicle: Members, usual: Members | None = None, **members: Any) -> Members:
    """A problem whose second vehicle differs from the first."""
    made = problem(usual, **members)
    made["vehicles"][1] |= vehicle
    return made


def read(value: Members, bounds: Bounds = Bounds()) -> Reading:  # noqa: B008  it is frozen
    return read_files([NamedFile("v.json", json.dumps(value).encode())], bounds, wanted=None)


def notes(reading: Reading) -> str:
    return " | ".join(note.text for note in reading.notes)


# The problem; the first objective's name and first leg or source; `fixed` of the first vehicle.
COSTS = {
    "nothing said": (problem(**CARS), "distance", 20_000, None),
    "the defaults said": (
        problem({"costs": {"fixed": 0, "per_hour": 3600, "per_km": 0}}, **CARS),
        *("distance", 20_000, None),
    ),
    "fixed, in seconds": (
        problem({"costs": {"fixed": 3600}}, **CARS),
        *("total time", 1800, 3600),
    ),
    "fixed and another rate for an hour": (
        problem({"costs": {"fixed": 100, "per_hour": 36}}, **CARS),
        *("total time", 1800, 10_000),
    ),
    "fixed and kilometres alone": (
        problem({"costs": {"fixed": 100, "per_hour": 0, "per_km": 50}}, **CARS),
        *("distance", 20_000, 2000),
    ),
    "hours and kilometres": (
        problem({"costs": {"fixed": 7, "per_hour": 36, "per_km": 2}}, **CARS),
        *("cost", 1800 / 100 + 40, 7),
    ),
    "fixed on the earth": (
        problem({"costs": {"fixed": 3600}}),
        *("total time", "great_circle", 3600),
    ),
    "fixed, hours and kilometres on the earth, at 30 km/h": (
        problem({"costs": {"fixed": 96, "per_hour": 36, "per_km": 2}}),
        *("total time", "great_circle", 96 / (36 + 60) * 3600),
    ),
    "a matrix of costs": (
        problem(
            {"costs": {"fixed": 9}},
            matrices={"car": {"durations": SECONDS, "costs": [[0, 8, 1], [8, 0, 1], [1, 1, 0]]}},
        ),
        *("cost", 8, 9),
    ),
    "the old matrix": (problem(matrix=SECONDS), "total time", 1800, None),
    "the profile of the vehicles, not the first": (
        problem(
            {"profile": "bike"},
            matrices={"car": {"durations": SECONDS}, "bike": {"durations": METRES}},
        ),
        *("total time", 20_000, None),
    ),
    "the same speed factor": (
        problem({"speed_factor": 1.5}, matrices={"car": {"durations": SECONDS}}),
        *("total time", 1200, None),
    ),
}


@pytest.mark.parametrize("name", COSTS)
def test_the_first_objective_is_what_vroom_minimises_where_costs_are_said(name: str) -> None:
    value, first, leg, fixed = COSTS[name]
    reading = read(value)
    [objective, second] = reading.request["objectives"]
    assert objective["name"] == first
    assert (objective["matrix"][0][1] if "matrix" in objective else objective["from"]) == leg
    assert objective["over"] == "sum"
    assert second["over"] == "max"
    assert reading.request["vehicles"][0].get("fixed") == fixed
    assert ("fixed" in {note.code for note in reading.notes}) == (
        fixed is not None and first != "cost"
    )
    parse_task(TaskSource("fleet", to_json(reading.request)), LIMITS, ACTORS)


# The problem; the first objective's first leg or source; and members of both vehicles.
DIFFERING = {
    "hours, by the travel times": (
        of_second({"costs": {"per_hour": 36}}, **CARS),
        *(1800, [{}, {"per_distance": 0.01}]),
    ),
    "kilometres alone": (
        of_second(
            {"costs": {"per_km": 50, "per_hour": 0}}, usual={"costs": {"per_km": 20, "per_hour": 0}}
        ),
        *("great_circle", [{"per_distance": 0.02}, {"per_distance": 0.05}]),
    ),
    "hours and kilometres": (
        of_second({"costs": {"per_km": 50, "per_hour": 36}}, **CARS),
        *(20_000, [{"per_distance": 0, "per_time": 1}, {"per_distance": 0.05, "per_time": 0.01}]),
    ),
    "speeds": (
        of_second({"speed_factor": 2}, **CARS),
        *(1800, [{}, {"speed_factor": 2, "per_distance": 0.5}]),
    ),
    "speeds on the earth": (
        of_second({"speed_factor": 0.5}),
        *("great_circle", [{}, {"speed_factor": 0.5, "per_distance": 2}]),
    ),
    "speeds beside a matrix of costs": (
        of_second({"speed_factor": 2}, matrices={"car": {"durations": SECONDS, "costs": METRES}}),
        *(20_000, [{}, {"speed_factor": 2}]),
    ),
}

BOTH = {"car": {"durations": SECONDS}, "truck": {"durations": METRES}}


def test_vehicles_of_several_profiles_have_matrices_of_their_own() -> None:
    reading = read(of_second({"profile": "truck"}, matrices=BOTH))
    first, longest = reading.request["objectives"]
    assert [each["profile"] for each in reading.request["vehicles"]] == ["car", "truck"]
    for objective in (first, longest):
        legs = {each["profile"]: each["matrix"][0][1] for each in objective["matrices"]}
        assert legs == {"car": 1800, "truck": 20_000}
    assert not [note for note in reading.notes if note.code == "left-out"]
    parse_task(TaskSource("fleet", to_json(reading.request)), LIMITS, ACTORS)


@pytest.mark.parametrize(("known", "profile"), [(("car", "truck"), "truck"), (("car",), None)])
def test_by_road_vehicles_have_the_profiles_that_the_routing_engine_knows(
    known: tuple[str, ...], profile: str | None
) -> None:
    reading = read(of_second({"profile": "truck"}), Bounds(roads=True, profiles=known))
    assert reading.request["vehicles"][1].get("profile") == profile
    assert ("does not know 'truck'" in notes(reading)) == (profile is None)


@pytest.mark.parametrize("name", DIFFERING)
def test_vehicles_that_differ_keep_their_own_prices_and_speeds(name: str) -> None:
    value, leg, members = DIFFERING[name]
    reading = read(value)
    [objective, longest] = reading.request["objectives"]
    assert (objective["matrix"][0][1] if "matrix" in objective else objective["from"]) == leg
    time = "longest route" if "matrix" in longest else "time"
    assert (objective["name"], longest["name"], longest["over"]) == ("cost", time, "max")
    own = ("per_distance", "per_time", "speed_factor")
    found = [
        {name: each[name] for name in own if name in each} for each in reading.request["vehicles"]
    ]
    assert found == members
    parse_task(TaskSource("fleet", to_json(reading.request)), LIMITS, ACTORS)


def test_types_of_vehicles_have_their_own_times_at_a_job() -> None:
    job = {"service": 60, "setup": 5, "service_per_type": {"bike": 90}}
    stop = read(of_second({"type": "bike"}, job=job)).request["stops"][1]
    assert (stop["service"], stop["services"]) == (65, [{"vehicle": "2", "service": 95}])


NOTED = {
    "per_hour of costs of vehicles is for the whole time": of_second(
        {"costs": {"per_km": 36}}, **CARS
    ),
    "per_km of costs of vehicles was not used: there are no matrices of distances": problem(
        {"costs": {"per_km": 5}}, matrices={"car": {"durations": SECONDS}}
    ),
    "per_task_hour of costs of vehicles": problem({"costs": {"per_task_hour": 36}}),
    "per_hour of costs of vehicles was not used: there are matrices of costs": problem(
        {"costs": {"per_hour": 5}}, matrices={"car": {"durations": SECONDS, "costs": METRES}}
    ),
    "distances of matrices": problem(
        matrices={"car": {"durations": SECONDS, "costs": METRES, "distances": METRES}}
    ),
    "matrix was read as durations in seconds": problem(matrix=SECONDS),
    "matrix of the problem": problem(matrix=SECONDS, **CARS),
    "All vehicles use the matrices of 'car': 'bike' was not used": of_second(
        {"profile": "bike"}, **CARS
    ),
    "profile of vehicles": problem({"profile": "truck"}),
    "distances of matrices was not used: not each profile has them": of_second(
        {"profile": "truck"}, matrices={**BOTH, "car": {"durations": SECONDS, "distances": METRES}}
    ),
    "speed_factor of vehicles": of_second({"speed_factor": "fast"}),
    "setup of jobs is part of each service": problem(job={"setup": 60, "location": NEAR}),
    "max_load of breaks of vehicles": problem(
        {"breaks": [{"id": 1, "service": 60, "time_windows": [[0, 900]], "max_load": [1]}]}
    ),
    "max_distance of vehicles was not used: total time is no distance": problem(
        {"max_distance": 9000}, matrices={"car": {"durations": SECONDS}}
    ),
    "priority of jobs": problem(job={"priority": 5}),
    "steps of vehicles": problem({"steps": [{"type": "start"}]}),
    "options of the problem": problem(options={"g": True}),
    "colour of vehicles": problem({"colour": "red"}),
    "zone of steps of shipments": problem(
        shipments=[
            {
                "pickup": {"id": 5, "location": NEAR, "zone": 3},
                "delivery": {"id": 6, "location": FAR},
            }
        ]
    ),
}


@pytest.mark.parametrize("sentence", NOTED)
def test_a_note_names_each_member_that_is_not_used(sentence: str) -> None:
    reading = read(NOTED[sentence])
    assert sentence in notes(reading)
    parse_task(TaskSource("fleet", to_json(reading.request)), LIMITS, ACTORS)


def test_nothing_is_noted_of_members_that_are_used() -> None:
    value = problem({"type": "van", "description": "white"}, {"service_per_type": {"van": 90}})
    reading = read(value)
    assert [stop.get("service") for stop in reading.request["stops"]] == [None, 90, 90]
    assert {note.code for note in reading.notes} == {"objectives"}


def test_a_set_up_is_part_of_the_service_where_one_task_is_at_a_place() -> None:
    reading = read(problem(job={"setup": 60, "service": 30}))
    assert [stop.get("service") for stop in reading.request["stops"]] == [None, 90, 90]
    assert "setup" not in notes(reading)


def test_what_is_picked_up_alone_is_the_demand() -> None:
    reading = read(problem({"capacity": [3]}, {"pickup": [2]}))
    assert [stop.get("demand") for stop in reading.request["stops"]] == [None, [2], [2]]
    assert "pickup" not in notes(reading)


SHIFT = {"time_window": [0, 36_000]}


@pytest.mark.parametrize(
    ("vehicle", "members", "limits"),
    [
        ({"max_distance": 9000}, {}, {"longest": 9000}),
        ({"max_travel_time": 900}, {}, {"longest": 900}),
        ({"max_travel_time": 900}, CARS, {"longest": 900}),
        ({"max_distance": 9000}, CARS, {"max_distance": 9000}),
        (
            {"max_travel_time": 900, "max_distance": 9000},
            *(CARS, {"longest": 900, "max_distance": 9000}),
        ),
        ({"max_travel_time": 900, **SHIFT}, {}, {"max_driving": 900}),
        (
            {"max_travel_time": 900, "max_distance": 9000, **SHIFT},
            *(CARS, {"max_driving": 900, "max_distance": 9000}),
        ),
    ],
)
def test_limits_on_driving_are_said_by_what_they_are_of(
    vehicle: Members, members: Members, limits: Members
) -> None:
    reading = read(problem(vehicle, **members))
    for each in reading.request["vehicles"]:
        names = ("longest", "max_distance", "max_driving")
        assert {name: each[name] for name in names if name in each} == limits
    assert "max_" not in notes(reading)
    parse_task(TaskSource("fleet", to_json(reading.request)), LIMITS, ACTORS)


def test_descriptions_tell_drivers_something() -> None:
    [detail] = read(problem(job={"description": "ring twice"})).details
    assert (detail.column, detail.texts) == ("description", ["", "ring twice", "ring twice"])


def test_a_speed_between_towns_is_told() -> None:
    value = problem({"time_window": [0, 36_000]})
    value["jobs"][0]["location"] = [25.9, 60.4]
    value["jobs"][1]["location"] = [24.1, 60.6]
    reading = read(value)
    assert reading.request["objectives"][1]["speed"] == 50
    assert "Times are along straight lines at 50 km/h" in notes(reading)


def test_by_road_a_fixed_cost_is_seconds_by_road() -> None:
    reading = read(problem({"costs": {"fixed": 60, "per_km": 2}}), Bounds(roads=True))
    sources = [objective["from"] for objective in reading.request["objectives"]]
    assert sources == ["road_time", "road_time"]
    assert "per_km of costs of vehicles was not used: times by road are not" in notes(reading)


REFUSED = [
    (problem({"costs": 5}), "vehicles/0/costs must be an object, got '5'"),
    (problem({"costs": {"fixed": "5"}}), "vehicles/0/costs/fixed must be a number from 0"),
    (problem({"costs": {"per_hour": -1}}), "vehicles/0/costs/per_hour must be a number from 0"),
    (problem(job={"setup": "1"}), "jobs/0/setup must be a time in seconds, got '1'"),
    (problem(job={"service_per_type": 3}), "jobs/0/service_per_type must be an object"),
    (problem(matrices={"car": SECONDS}), "matrices/car must be an object"),
    (problem(matrix=[[0, 1], [1, 0]]), "must have a row and a column for each location_index"),
    (problem({"speed_factor": [2]}, jobs=5), "jobs must be a list of objects"),
    ({"vehicles": [], "jobs": []}, "vehicles must be a list of one or more"),
]


@pytest.mark.parametrize(("value", "sentence"), REFUSED)
def test_a_wrong_member_is_refused_by_name(value: Members, sentence: str) -> None:
    with pytest.raises(UnreadableFile) as refused:
        read(value)
    assert sentence in str(refused.value)
