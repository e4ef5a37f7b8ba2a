"""Fronts as a notebook shows them: a line, HTML, a table of pandas, a plot of matplotlib."""

from io import StringIO
from xml.etree import ElementTree

import matplotlib as mpl
import moocore
import paretour
import pytest
from paretour import Client
from paretour.values import Front, parse_front

from tests.helpers.answers import EMPTY, FRONT, NAMED

mpl.use("Agg")
THREE = {
    **FRONT,
    "front": [
        {"losses": [0, 1, 0.5], "lengths": [1.0, 5.0, 3.0], "tour": [0, 1, 2]},
        {"losses": [1, 0, 0.5], "lengths": [2.0, 4.0, 3.0], "tour": [0, 2, 1]},
    ],
    "reference_point": [9.0, 9.0, 9.0],
    "scale": [1.0, 1.0, 1.0],
}


def test_a_front_is_a_sequence_of_tours() -> None:
    front = parse_front(NAMED)
    assert len(front) == 2
    assert [tour.tour.tolist() for tour in front] == front.tours.tolist()
    assert front[-1].stops == front[1].stops == ("depot", "c", "b 2")
    for index in (2, -3):
        with pytest.raises(IndexError, match="2 tours of 3 cities"):
            front[index]


@pytest.mark.parametrize("document", [FRONT, NAMED, EMPTY, THREE])
def test_a_front_is_one_short_line_and_well_formed_html(document: dict[str, object]) -> None:
    front = parse_front(document)
    assert len(repr(front)) < 300
    assert "\n" not in repr(front)
    html = ElementTree.fromstring(front._repr_html_())
    assert html.find("script") is None
    rows = html.findall("table/tbody/tr")
    assert len(rows) == len(front)
    marks = {"circle": 2, "polyline": 3}
    drawn = [html.iter(f"{{http://www.w3.org/2000/svg}}{mark}") for mark in marks]
    assert sum(len(list(each)) for each in drawn) == len(front)


def test_names_from_outside_are_text_in_html_and_in_plots() -> None:
    name = "<script>alert(1)</script> $x^2$"
    document = {**NAMED, "objectives": [{"name": name, "unit": None}, {"name": "b", "unit": "m"}]}
    front = parse_front(document)
    assert "<script" not in front._repr_html_()
    axes = front.plot()
    assert axes.get_xlabel() == name
    axes.figure.canvas.draw()


def test_a_table_has_a_row_for_each_tour() -> None:
    table = parse_front(NAMED).to_frame()
    assert table["way"].tolist() == parse_front(NAMED).lengths[:, 0].tolist()
    assert table["tour"].tolist() == [("depot", "b 2", "c"), ("depot", "c", "b 2")]
    assert len(parse_front(EMPTY).to_frame()) == 0


@pytest.mark.parametrize("document", [NAMED, THREE])
def test_moocore_reads_a_front_as_it_is(document: dict[str, object]) -> None:
    front = parse_front(document)
    both = moocore.read_datasets(StringIO(front.to_moocore() * 2))
    assert both[:, :-1].tolist() == front.lengths.tolist() * 2
    assert both[:, -1].tolist() == [1] * len(front) + [2] * len(front)


def test_a_front_has_the_names_of_pymoo() -> None:
    front = parse_front(NAMED)
    assert front.F.tolist() == front.lengths.tolist()
    assert front.X.tolist() == front.tours.tolist()


def test_three_objectives_are_drawn_in_space_and_four_are_refused() -> None:
    assert parse_front(THREE).plot().name == "3d"
    four = parse_front(
        {
            **THREE,
            "front": [{"losses": [0] * 4, "lengths": [1.0] * 4, "tour": [0, 1, 2]}],
            "reference_point": [9.0] * 4,
            "scale": [1.0] * 4,
        }
    )
    with pytest.raises(ValueError, match="two or three"):
        four.plot()


def test_tours_over_the_day_say_when_they_leave_and_arrive(url: str) -> None:
    matrix = [[0, 60, 90], [60, 0, 30], [90, 30, 0]]
    with Client(url.removeprefix("http://")) as client:
        front: Front = client.front(
            stops=[{"id": "a"}, {"id": "b", "service": 10}, {"id": "c"}],
            objectives=[
                {"name": "time", "unit": "s", "matrix": matrix, "over_the_day": [[0, 1], [50, 2]]},
                {"name": "risk", "matrix": matrix},
            ],
            departure=30,
        )
        rest = client.replan(front, done=["a"], now=40)
    assert front.departures is not None
    assert front.times is not None
    assert front.departures.tolist() == [30.0] * len(front)
    assert front[0].times is not None
    assert front[0].times[-1] == 30 + front[0].lengths[0]
    assert front.to_frame()["departure"].tolist() == front.departures.tolist()
    assert rest.departures is not None
    assert rest.departures[0] == 40


def test_a_table_of_a_fleet_has_every_route_of_vehicles_of_one_type(url: str) -> None:
    matrix = [[0, 5, 5], [5, 0, 9], [5, 9, 0]]
    with Client(url) as client:
        front = client.fleet(
            stops=[{"id": "depot"}, {"id": "a", "demand": [1]}, {"id": "b", "demand": [1]}],
            vehicles=[{"id": "van", "count": 2, "start": 0, "end": 0, "capacity": [1]}],
            objectives=[
                {"name": "driving", "matrix": matrix},
                {"name": "longest", "matrix": matrix, "over": "max"},
            ],
        )
    assert (len(front.F), front.X.tolist()) == (len(front), list(front.plans))
    [routes, *_] = front.to_frame()["routes"]
    assert sorted(routes) == [("van", ("depot", "a", "depot")), ("van", ("depot", "b", "depot"))]


def test_the_package_has_a_version() -> None:
    assert paretour.__version__.count(".") == 2
