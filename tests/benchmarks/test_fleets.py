"""The benchmark of fleets measures each of its sets, and is right about lengths and rules."""

import subprocess
from pathlib import Path
from typing import Any

import pytest

from service.fleet.evaluation import points_of
from tests.benchmarks import fleet_table, provenance
from tests.benchmarks.fleet_instances import fleet_of
from tests.benchmarks.rivals import earlier_fleets
from tests.benchmarks.street_fleets import street_fleets
from tests.helpers.sampled import at_night

# A vehicle holds two of three customers. One that visits 2 after 1 is on its way for 24.
WINDOWS = """T1

VEHICLE
NUMBER     CAPACITY
  3         10

CUSTOMER
CUST NO.  XCOORD.   YCOORD.    DEMAND   READY TIME  DUE DATE   SERVICE TIME

    0      0         0          0       0         40           0
    1      3         4          5       10        20           2
    2      6         8          5       0         30           2
    3      0         1          6       0         30           2
"""
# One vehicle does for both shipments, whose pick-ups are on its way.
SHIPMENTS = """2 10 1
0 0 0 0 0 100 0 0 0
1 3 4 5 0 100 2 0 2
2 6 8 -5 0 100 2 1 0
3 3 4 5 0 100 2 0 4
4 6 8 -5 0 100 2 3 0
"""
CAPACITY = """NAME : X-t
TYPE : CVRP
DIMENSION : 4
EDGE_WEIGHT_TYPE : EUC_2D
CAPACITY : 10
NODE_COORD_SECTION
1 0 0
2 3 4
3 6 8
4 0 1
DEMAND_SECTION
1 0
2 5
3 5
4 6
DEPOT_SECTION
1
-1
EOF
"""
FILES = {
    "deep/t1.TXT": WINDOWS,
    "deep/t1.sol": "Route #1: 1 2\nRoute #2: 3\nCost 22\n",
    "LT.txt": SHIPMENTS,
    "X-t.vrp": CAPACITY,
    "X-t.sol": "Route #1: 2 1\nRoute #2: 3\nCost 22\n",
}
REQUEST: dict[str, Any] = {
    "stops": [{"id": "0"}, *({"id": str(stop), "demand": [7]} for stop in (1, 2, 3))],
    "vehicles": [{"id": "van", "start": "0", "end": "0", "capacity": [10], "shift": [0, 100]}],
    "objectives": [
        {"name": "total", "coordinates": [[0, 0], [3, 0], [0, 4], [-3, 4]], "over": "sum"},
        {"name": "longest", "coordinates": [[0, 0], [3, 0], [0, 4], [-3, 4]], "over": "max"},
    ],
    "clock": "longest",
}
TOTAL = [22.0, 20.0]  # and the longest route, without and with time
BOTH = {
    "solomon: T1": {"points": [[22.0, 2.0]], "least_known": 22.0},
    "homberger: T1": {"points": [[22.0, 2.0]], "least_known": 22.0},
    "li-lim: LT": {"points": [[20.0, 1.0]]},
    "x: X-t": {"points": [TOTAL], "least_known": 22.0},
    "longest: T1": {"points": [[22.0, 24.0], [32.0, 22.0]], "least_known": 22.0},
}


@pytest.fixture
def fleets(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """The benchmark, which stores in a folder of its own."""
    monkeypatch.setattr(provenance, "RESULTS", tmp_path / "results")
    monkeypatch.setattr(provenance, "changed_files", list)
    for package in ("ortools", "pyvrp"):
        pytest.importorskip(package, reason="needs the extra bench")
    return pytest.importorskip("tests.benchmarks.fleets", reason="needs the extra bench")


@pytest.mark.parametrize("row", BOTH)
def test_files_are_planned_by_us_and_by_the_rival(fleets: Any, row: str, tmp_path: Path) -> None:
    for name, text in FILES.items():
        path = tmp_path / "data" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    chosen, name = row.split(": ")
    data = str(tmp_path / "data")
    fleets.main(["--sets", chosen, "--data", data, "--names", name, "--seconds", "0.2"])
    stored = provenance.load("fleets")
    methods = fleets.FILES[chosen].methods
    assert list(stored) == [f"{row}, {method}, 0.2 s" for method in methods]
    for entry in stored.values():
        (found,) = entry["instances"]
        assert found.pop("seconds") > 0
        assert found == BOTH[row]


def test_recipes_are_planned_and_printed(fleets: Any, capsys: pytest.CaptureFixture[str]) -> None:
    sizes = ["--sizes", "20", "--count", "1", "--seconds", "0.4"]
    fleets.main(["--sets", "uniform", "bi-cvrp", *sizes])
    stored = provenance.load("fleets")
    assert list(stored) == [
        "uniform: 20 stops, paretour, 0.4 s",
        "uniform: 20 stops, PyVRP in a sweep, 0.4 s",
        "uniform: 20 stops, PyVRP alone, 0.4 s",
        "bi-cvrp: 20 customers, paretour without a search, 0 s",
        "bi-cvrp: 20 customers, paretour, 0.4 s",
        "bi-cvrp: 20 customers, PyVRP in a sweep, 0.4 s",
        "bi-cvrp: 20 customers, OR-Tools in a sweep, 0.4 s",
    ]
    for key, entry in stored.items():
        assert entry["instances"][0]["points"] or "paretour" not in key  # a rival may find nothing
    printed = capsys.readouterr().out
    assert "| 20 stops (1) | PyVRP in a sweep |" in printed
    assert "| paretour without a search | 0.5" in printed  # of the literature's box


@at_night
def test_late_orders_on_streets_are_planned_by_us_and_by_the_earlier_engine(fleets: Any) -> None:
    commit = f"{earlier_fleets.COMMIT}^{{commit}}"
    known = subprocess.run(["git", "cat-file", "-e", commit], cwd=provenance.ROOT, check=False)
    if known.returncode:
        pytest.skip("this clone lacks the commit of the earlier engine")
    fleets.main(["--sets", "streets", "--sizes", "59", "--seconds", "2"])
    stored = provenance.load("fleets")
    assert list(stored) == [
        f"streets: 59 orders, {count} objectives, 2 s, {method}, 2 s"
        for count in (2, 3)
        for method in ("paretour", "the earlier engine with PyVRP")
    ]
    for key, entry in stored.items():
        (found,) = entry["instances"]
        assert {len(point) for point in found["points"]} == {2 if "2 objectives" in key else 3}


def test_each_hour_that_a_customer_named_may_be_missed() -> None:
    (instance,) = street_fleets(59, objectives=2, instances=1)
    named = [stop for stop in instance.request["stops"] if "due" in stop]
    assert len(named) == 20
    for stop in named:
        begins, closes = stop["window"]
        assert (stop["due"], closes) == (begins + 3600, 12 * 3600)


def test_a_vehicle_of_pyvrp_loads_again() -> None:
    """It holds the demand of one of three stops, which are 3, 4 and 5 away from the depot."""
    rival = pytest.importorskip("tests.benchmarks.rivals.pyvrp_fleets", reason="needs the extra")
    (vehicle,) = REQUEST["vehicles"]
    once = fleet_of(REQUEST)
    often = fleet_of({**REQUEST, "vehicles": [{**vehicle, "reload": ["0"]}]})
    assert rival.least_total(once, 0.1) == []
    assert points_of(often, rival.least_total(often, 0.1)).tolist() == [[24.0, 24.0]]


def test_best_known_plans_are_hit_by_as_few_vehicles_and_as_short_routes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of C101, 10 vehicles and 828.94; of R101, 19 and 1650.80; of R112, 9 and 982.14."""
    monkeypatch.setattr(provenance, "RESULTS", tmp_path)
    monkeypatch.setattr(provenance, "changed_files", list)
    where = {"cpu": "abacus", "date": "today", "commit": "none", "digest": "", "busy": 0.0}
    fronts = {
        "C101": {"points": [[828.94, 10]], "least_known": 828.94},
        "R101": {"points": [[1642.88, 20], [1667.308, 19]], "least_known": 1642.88},
        "R112": {"points": [[960.0, 10]]},
        "R108": {"points": []},
    }
    rows = {
        f"solomon: {name}, paretour, 10 s": {**where, "instances": [{"seconds": 10.0, **found}]}
        for name, found in fronts.items()
    }
    provenance.store("fleets", rows)
    assert "| paretour | 4 | 39 | 2 | 0.50 % | 1 | 0.00 % | 1 | 10.0 s |" in fleet_table.table_of(
        "solomon"
    )
