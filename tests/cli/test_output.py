"""Fronts, tours and actors in the formats that the command prints."""

import csv
import io
import json
from typing import Any

import pytest
from paretour import FleetFront, Front, Plan
from paretour.kinds import KINDS, parse_any
from paretour.values import parse_front
from rich.console import Console

from service.cli.data import csv_text
from service.cli.fronts import print_chart, run_front, run_tour
from service.cli.options import OutputFormat, Ways
from service.cli.output import (
    front_as_rows,
    front_as_table,
    front_summary,
    ids_of,
    named_tours,
    plans_as_rows,
    stops_of,
    tour_as_json,
    tour_summary,
)
from service.mcp.summaries import tour_text
from tests.helpers.answers import FRONT, NAMED
from tests.helpers.version_before import ANSWERS

THE_FRONT = parse_front(FRONT)
NAMED_FRONT = parse_front(NAMED)


class Prepared:
    """A backend that has a front already."""

    def front(self, plan: Plan, console: Console) -> Front:
        assert (plan.path, console.stderr) == ("/front", True)
        return THE_FRONT

    def actors(self) -> tuple[Any, ...]:
        return ()


def build_plan() -> tuple[Plan, None]:
    return Plan("/front", {}), None


def build_named() -> tuple[Plan, tuple[str, ...]]:
    return Plan("/front", {}), ("depot", "b 2", "c")


def test_json_is_the_answer_of_the_service(capsys: pytest.CaptureFixture[str]) -> None:
    run_front(build_plan, Prepared(), OutputFormat(as_json=True))
    assert json.loads(capsys.readouterr().out) == FRONT


def test_csv_has_a_line_for_each_tour() -> None:
    rows = list(csv.DictReader(io.StringIO(csv_text(front_as_rows(THE_FRONT)))))
    assert rows[0] == {"angle": "60.0", "length_1": "1.0", "length_2": "2.0", "tour": "0 1 2"}
    assert len(rows) == 2


def test_csv_names_the_column_of_routes_that_a_plan_compares_after_what_they_have() -> None:
    way, time = ANSWERS["fleet"]["objectives"]
    imbalance = {**time, "name": "imbalance", "measure": "imbalance"}
    front = parse_any({**ANSWERS["fleet"], "objectives": [way, imbalance]})
    assert isinstance(front, FleetFront)
    [head, *_] = plans_as_rows(front, KINDS["fleet"])
    lengths = "way", "imbalance", "vehicle", "route way", "whole route"
    assert head == ("plan", "balance", *lengths, "stops")


def test_csv_has_names_units_and_ids_where_the_request_had_them() -> None:
    ids = ids_of(NAMED_FRONT)
    rows = list(csv.DictReader(io.StringIO(csv_text(front_as_rows(NAMED_FRONT, ids)))))
    first = {"angle": "60.0", "way (m)": "1.0", "risk [red]$": "2.0", "tour": 'depot "b 2" c'}
    assert rows[0] == first


def test_a_summary_and_json_of_a_tour_have_names_and_ids() -> None:
    tour = NAMED_FRONT.nearest(60)
    assert tour_summary(NAMED_FRONT, tour) == "balance 0.000, angle 60.00, way 1 m, risk [red]$ 2"
    assert json.loads(tour_as_json(tour)) == NAMED["front"][0]  # type: ignore[index]


def test_a_tour_says_its_mean_and_nine_days_of_ten() -> None:
    spread = {"means": [1680.0, 2.0], "p90": [2040.0, 2.0]}
    items = [{**item, **spread} for item in NAMED["front"]]  # type: ignore[attr-defined]
    seconds = [{"name": "time", "unit": "s"}, NAMED["objectives"][1]]  # type: ignore[index]
    front = parse_front(NAMED | {"front": items, "objectives": seconds})
    tour, said = front.nearest(60), "28 min on average; nine days of ten within 34 min"
    assert tour_summary(front, tour).endswith(f"risk [red]$ 2; time {said}")
    assert json.loads(tour_as_json(tour)) == items[0]
    assert json.loads(tour_text(front, 0, 0, None))["on_most_days"] == {"time": said}
    head, first, *_ = front_as_rows(front)
    assert head == ("angle", "time (s)", "risk [red]$", "mean time (s)", "p90 time (s)", "tour")
    assert first[3:5] == (1680, 2040)


def test_a_plan_says_how_surely_it_is_on_time() -> None:
    spread = {"on_time": 0.94, "duration": 1680.0, "duration_p90": 2040.0}
    plans = [{**each, "measures": spread} for each in ANSWERS["fleet"]["front"]]
    clock = {"name": "time", "unit": "s"}
    front = parse_any(ANSWERS["fleet"] | {"front": plans, "clock": clock})
    assert isinstance(front, FleetFront)
    head, first, *_ = plans_as_rows(front, KINDS["fleet"])
    assert dict(zip(head, first, strict=True)).items() >= spread.items()
    told = json.loads(tour_text(front, 0, 0, None))
    said = "28 min on average; nine days of ten within 34 min"
    assert told["on_most_days"] == {"all routes together": said}
    assert told["measures"]["on_time"] == "94 % of visits"


def test_a_chart_and_tables_have_names_as_they_are() -> None:
    stream = io.StringIO()
    console = Console(file=stream, width=100)
    print_chart(NAMED_FRONT, console)
    console.print(named_tours(NAMED_FRONT))
    console.print(front_as_table(NAMED_FRONT))
    printed = stream.getvalue()
    chart, _, tables = printed.partition("least")
    assert "way (m)" in chart
    assert "risk [red]$" in chart
    assert "risk [red]$" in tables
    assert "least risk [red]$" in printed


def test_a_table_has_a_row_for_each_tour() -> None:
    assert front_as_table(THE_FRONT).row_count == 2


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({}, "2 of 2 tours found, hypervolume 50.00%; nothing more was found"),
        ({"hypervolume_bound": 0.75}, "hypervolume 50.00%, and no front has more than 75.00%;"),
        ({"points": 9, "terminated": "cancelled"}, "2 of 9 tours found, hypervolume 50.00%; stop"),
    ],
)
def test_a_summary_says_how_good_a_front_is(changed: dict[str, Any], words: str) -> None:
    assert words in front_summary(parse_front(FRONT | changed))


def test_a_tour_is_its_cities_or_an_item_of_the_front() -> None:
    tour = THE_FRONT.nearest(60)
    assert stops_of(tour.tour) == [0, 1, 2]
    assert json.loads(tour_as_json(tour)) == FRONT["front"][0]  # type: ignore[index]
    assert tour_summary(THE_FRONT, tour) == "balance 0.000, angle 60.00, lengths 1 and 2"


@pytest.mark.parametrize(
    ("output", "first"),
    [(OutputFormat(as_json=True), "{"), (OutputFormat(as_csv=True), "angle,length_1")],
)
def test_a_front_is_printed_in_the_format_asked_for(
    output: OutputFormat, first: str, capsys: pytest.CaptureFixture[str]
) -> None:
    run_front(build_plan, Prepared(), output)
    printed = capsys.readouterr()
    assert printed.out.startswith(first)
    assert printed.err == front_summary(THE_FRONT) + "\n"


def test_the_tour_at_an_angle_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    run_tour(build_plan, Prepared(), Ways(angle=30))
    line = "balance 1.000, angle 30.00, lengths 2 and 1\n"
    assert capsys.readouterr() == ("0 2 1\n", line)


def test_cities_go_by_their_ids_where_they_have_some(capsys: pytest.CaptureFixture[str]) -> None:
    run_tour(build_named, Prepared(), Ways(balance=0.9))
    assert capsys.readouterr().out == 'depot c "b 2"\n'
    run_front(build_named, Prepared(), OutputFormat(as_csv=True))
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert next(csv.reader([rows[0]["tour"]], delimiter=" ")) == ["depot", "b 2", "c"]
    run_tour(build_named, Prepared(), Ways(second_at_most=1.0), as_json=True)
    assert json.loads(capsys.readouterr().out)["tour"] == [0, 2, 1]


def test_a_front_that_is_piped_is_a_whole_table(capsys: pytest.CaptureFixture[str]) -> None:
    run_front(build_plan, Prepared(), OutputFormat())
    assert "knee" not in capsys.readouterr().out


@pytest.mark.parametrize(("as_table", "is_there"), [(False, True), (True, False)])
def test_a_front_on_a_terminal_is_a_chart_and_three_tours(
    as_table: bool, is_there: bool, capsys: pytest.CaptureFixture[str], monkeypatch: Any
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")  # which rich takes for a terminal
    run_front(build_plan, Prepared(), OutputFormat(as_table=as_table))
    printed = capsys.readouterr().out
    assert all((word in printed) == is_there for word in ("knee", "least second length", "+---"))
    assert "first length" in printed
