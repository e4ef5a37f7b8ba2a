"""`paretour fleet`: the formats that it prints, and what it refuses."""

import csv
import io
import json
import shutil
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from service.cli.plans import plan_fleet
from tests.files.test_examples import FOLDER as EXAMPLES
from tests.helpers.command import paretour
from tests.helpers.fleet_requests import fleet_request


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "fleet.json"
    path.write_text(json.dumps(fleet_request()))
    return path


def test_a_fleet_is_planned_by_a_service_and_printed_as_lines_of_routes(
    file: Path, url: str
) -> None:
    ended = paretour("fleet", file, "--url", url, "--csv", "--size", 2)
    assert ended.returncode == 0, ended.stderr
    rows = list(csv.DictReader(io.StringIO(ended.stdout)))
    assert {row["plan"] for row in rows} <= {"0", "1"}
    assert {row["vehicle"] for row in rows} <= {"van", "bike"}
    assert all(row["stops"].split()[0] == "stop-0" for row in rows)
    assert float(rows[0]["distance"]) >= float(rows[0]["route distance"])


def test_this_process_plans_a_fleet_as_a_table(file: Path, quick_actors: dict[str, str]) -> None:
    ended = paretour("fleet", file, "--time-limit", 0.1, **quick_actors)
    assert ended.returncode == 0, ended.stderr
    assert "time (min)" in ended.stdout
    assert "hypervolume" in ended.stderr


ORDERS = (
    "id,lat,lon,demand,service\ndepot,60.17,24.94,0,0\na,60.18,24.95,3,60\nb,60.16,24.93,2,60\n"
)


def test_a_table_with_demands_is_planned_as_a_fleet_and_not_as_a_front(
    tmp_path: Path, quick_actors: dict[str, str]
) -> None:
    orders = tmp_path / "orders.csv"
    orders.write_text(ORDERS)
    ended = paretour("fleet", orders, "--csv", "--time-limit", 0.1, **quick_actors)
    assert ended.returncode == 0, ended.stderr
    assert "depot a b depot" in ended.stdout or "depot b a depot" in ended.stdout
    assert "'demand' (demand)" in ended.stderr
    assert "Times are along straight lines at 30 km/h" in ended.stderr
    refused = paretour("front", orders)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert "`paretour fleet` plans that" in refused.stderr


VEHICLES = "vehicle,capacity,shift start,shift end\nvan,4,08:00,17:00\nbike,3,,\n"


def test_a_table_of_stops_and_one_of_vehicles_are_planned_as_a_fleet(
    tmp_path: Path, quick_actors: dict[str, str]
) -> None:
    (tmp_path / "stops.csv").write_text(ORDERS)
    (tmp_path / "vehicles.csv").write_text(VEHICLES)
    options = ("--csv", "--time-limit", 0.1)
    ended = paretour(
        "fleet", "stops.csv", "vehicles.csv", *options, folder=tmp_path, **quick_actors
    )
    assert ended.returncode == 0, ended.stderr
    rows = list(csv.DictReader(io.StringIO(ended.stdout)))
    assert {row["vehicle"] for row in rows} == {"van", "bike"}
    assert "'capacity' (capacity)" in ended.stderr
    refused = paretour("fleet", "stops.csv", "stops.csv", folder=tmp_path)
    assert refused.returncode == 2
    assert "stops.csv: must have columns of vehicles" in refused.stderr
    shutil.copy(EXAMPLES / "cvrp.vrp", tmp_path)
    refused = paretour("fleet", "cvrp.vrp", "vehicles.csv", folder=tmp_path)
    assert refused.returncode == 2
    assert "must be a table of stops and one of vehicles" in refused.stderr


def test_vehicles_or_stops_may_be_standard_input(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, text in (("stops.csv", ORDERS), ("vehicles.csv", VEHICLES)):
        (tmp_path / name).write_text(text)
    for files, text in (
        ((tmp_path / "stops.csv", Path("-")), VEHICLES),
        ((Path("-"), tmp_path / "vehicles.csv"), ORDERS),
    ):
        monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(text.encode())))
        request = plan_fleet(*files, {})[0].request
        assert [each["id"] for each in request["vehicles"]] == ["van", "bike"]


def test_a_fleet_may_be_standard_input(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(ORDERS.encode())))
    request = plan_fleet(Path("-"), None, {"size": 3})[0].request
    assert [stop["id"] for stop in request["stops"]] == ["depot", "a", "b"]
    assert (request["size"], request["vehicles"][0]["capacity"]) == (3, [5])


def test_a_file_that_is_no_request_and_two_formats_are_refused(file: Path) -> None:
    both = paretour("fleet", file, "--json", "--csv")
    assert (both.returncode, both.stdout) == (2, "")
    file.write_text("[1]")
    ended = paretour("fleet", file)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert "must be a list of rows, or of objects, got 1" in ended.stderr
