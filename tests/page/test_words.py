"""How the page puts lengths, times and choices into words: its modules, in Node."""

from typing import Any

import pytest

from tests.helpers.node import Node

TITLE_AND_TICK = """async ([objective, value, step]) => {
  const { axisOf } = await import("./page/common/axes.js");
  const { title, said } = axisOf(objective);
  return [title, said(value, step)];
}"""
TOURS = {"one": "tour", "many": "tours"}
PLANS = {"one": "plan", "many": "plans"}
MINUS = "\N{MINUS SIGN}"
TIMES_M = "risk \N{MULTIPLICATION SIGN} m"


@pytest.mark.parametrize(
    ("unit", "value", "step", "title", "tick"),
    [
        ("s", 2700, 300, "Driving", "45 min"),
        ("s", 5400, 900, "Driving", "1:30 h"),
        ("s", 1950, 30, "Driving", "32:30 min"),
        ("s", 5430, 30, "Driving", "1:30:30 h"),
        ("s", 15, 5, "Driving", "15 s"),
        ("s", -15, 5, "Driving", f"{MINUS}15 s"),
        ("min", 60, 1, "Driving", "1:00 h"),
        ("h", 25, 1, "Driving", "25:00 h"),
        ("m", 2700, 100, "Driving", "2,700 m"),
        ("m", 9576.97, 0.01, "Driving", "9,576.97 m"),
        ("m", 12_000, 1000, "Driving", "12 km"),
        ("m", 12_345, 5, "Driving", "12.345 km"),
        ("km", 12_345, 5, "Driving, km", "12,345"),
        ("", 2700, 100, "Driving", "2,700"),
    ],
)
def test_times_are_in_hours_and_minutes_on_the_chart(
    node: Node, unit: str, value: float, step: float, title: str, tick: str
) -> None:
    objective = {"name": "driving", "unit": unit}
    assert node.evaluate(TITLE_AND_TICK, [objective, value, step]) == [title, tick]


@pytest.mark.parametrize(
    ("objective", "title", "tick"),
    [
        ({"name": "vehicles", "measure": "vehicles", "unit": ""}, "Vehicles", "7"),
        ({"name": "people passed", "unit": "people"}, "People passed", "7.2"),
        ({"name": "risk", "unit": TIMES_M}, TIMES_M.capitalize(), "7.2"),
        ({"name": "overlap", "measure": "overlap", "unit": "%"}, "Overlap, %", "720"),
        ({"name": "stops changed", "measure": "changes", "unit": "stops"}, "Stops changed", "7.2"),
    ],
)
def test_the_title_of_an_axis_says_the_unit_where_nothing_else_does(
    node: Node, objective: dict[str, Any], title: str, tick: str
) -> None:
    assert node.evaluate(TITLE_AND_TICK, [objective, 7.2, 1]) == [title, tick]


@pytest.mark.parametrize(
    ("value", "amount", "figure"),
    [
        (340, "340 m", "340 m"),
        (9_994.4, "9,990 m", "9,994.4 m"),
        (9_996, "10 km", "9,996 m"),
        (134_123.4, "134 km", "134.123 km"),
    ],
)
def test_from_ten_thousand_metres_on_a_distance_is_in_kilometres(
    node: Node, value: float, amount: str, figure: str
) -> None:
    distance = {"name": "distance", "unit": "m"}
    assert node.call("common/amounts.js", "amount", value, distance) == amount
    assert node.call("common/amounts.js", "figure", value, distance) == figure


@pytest.mark.parametrize(
    ("name", "unit", "less"),
    [
        ("people passed", "people", "fewer"),
        ("left turns", "", "fewer"),
        ("vehicles", "", "fewer"),
        ("turns", "s", "less"),
        ("crowds", "people", "less"),
        ("risk", "", "less"),
    ],
)
def test_there_are_fewer_things_and_less_of_a_sum(
    node: Node, name: str, unit: str, less: str
) -> None:
    said = node.call("common/amounts.js", "lessOf", {"name": name, "unit": unit})
    assert said == f"{less} {name}"


@pytest.mark.parametrize(
    ("seconds", "said", "exactly"),
    [
        (0, "0 min", "0 min"),
        (45, "45 s", "45 s"),
        (150, "2 min 30 s", "2 min 30 s"),
        (725, "12 min", "12 min 5 s"),
        (3600, "1 h", "1 h"),
        (3599, "60 min", "59 min 59 s"),
        (3900, "1 h 5 min", "1 h 5 min"),
        (90_061, "25 h 1 min", "25 h 1 min"),
    ],
)
def test_how_long_something_takes(node: Node, seconds: int, said: str, exactly: str) -> None:
    assert node.call("common/durations.js", "duration", seconds) == said
    assert node.call("common/durations.js", "duration", seconds, {"exact": True}) == exactly


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("8", 28_800),
        ("8:30", 30_600),
        ("8.30", 30_600),
        ("0830", 30_600),
        ("8h30", 30_600),
        ("8:30 Uhr", 30_600),
        ("8 am", 28_800),
        ("12 am", 0),
        ("1:30 pm", 48_600),
        ("26:00", 93_600),
        ("10:30:15", 37_815),
        ("13 pm", None),
        ("7.3o", None),
        ("25", None),
        ("8:75", None),
    ],
)
def test_a_time_of_day_is_read_as_people_write_it(
    node: Node, text: str, seconds: int | None
) -> None:
    assert node.call("common/durations.js", "timeOfDay", text) == seconds


METRES = {"name": "distance", "unit": "m"}
SECONDS = {"name": "driving", "unit": "s"}
PRIZES = {"name": "prizes", "measure": "unassigned", "unit": "m"}
LATENESS = {"name": "lateness", "measure": "lateness", "unit": "s"}


@pytest.mark.parametrize(
    ("objective", "value", "beside", "said"),
    [
        (METRES, 5000, 4000, "+25.0 %"),
        (METRES, 4000, 5000, f"{MINUS}20.0 %"),
        (METRES, 4000, 4000, "0.0 %"),
        (METRES, 4000, 0, ""),
        (LATENESS, 0, 780, f"{MINUS}13 min"),
        (LATENESS, 780, 780, "same"),
        (PRIZES, 900, 0, "+900 m"),
    ],
)
def test_how_much_more_one_has_than_another(
    node: Node, objective: dict[str, Any], value: float, beside: float, said: str
) -> None:
    assert node.call("common/amounts.js", "change", value, beside, objective) == said


@pytest.mark.parametrize(
    ("first", "unit", "carried", "said"),
    [
        ("m", "load-km", [1_234_000, 800_000], ["1,234", "800"]),
        ("s", "load-hours", [129_600, 33_300], ["36", "9.25"]),
        ("eur", "load \N{MULTIPLICATION SIGN} eur", [36, 9], ["36", "9"]),
    ],
)
def test_what_is_carried_is_counted_in_the_unit_of_the_first_costs(
    node: Node, first: str, unit: str, carried: list[float], said: list[str]
) -> None:
    objectives = [
        {"name": "way", "unit": first},
        {"name": "load carried", "measure": "load_distance"},
    ]
    _, load = node.call("fleet/units.js", "withUnits", objectives, {})
    assert load["unit"] == unit
    assert [node.call("common/amounts.js", "figure", each, load) for each in carried] == said


VEHICLES = {"name": "vehicles", "measure": "vehicles", "unit": ""}
LONGEST = {"name": "longest route", "unit": "s", "over": "max"}
RISK = {"name": "risk", "unit": ""}


def front(*lengths: list[float]) -> list[dict[str, Any]]:
    return [{"lengths": each} for each in lengths]


@pytest.mark.parametrize(
    ("lengths", "at", "objectives", "noun", "said"),
    [
        (
            [[4000, 9], [4400, 6], [5000, 3]],
            0,
            [METRES, RISK],
            TOURS,
            "The least distance. Every other tour has less risk, for more distance.",
        ),
        (
            [[4000, 9], [4400, 6], [5000, 3]],
            1,
            [METRES, RISK],
            TOURS,
            "10 % more distance (400 m) than the least, for 33 % less risk.",
        ),
        (
            [[4000, 9], [4400, 6], [5000, 7]],
            2,
            [METRES, RISK],
            PLANS,
            "Another plan is better under both objectives, but this one changes less of the plan"
            " before.",
        ),
        (
            [[4000, 9], [4400, 6], [5000, 3]],
            2,
            [METRES, RISK],
            TOURS,
            "25 % more distance (1,000 m) than the least,"
            " for 67 % less risk: the least of all tours found.",
        ),
        (
            [[4000, 7], [5000, 5]],
            1,
            [METRES, VEHICLES],
            PLANS,
            "25 % more distance (1,000 m) than the least,"
            " for 2 fewer vehicles: the fewest of all plans found.",
        ),
        (
            [[4000, 780], [5000, 0]],
            1,
            [METRES, LATENESS],
            PLANS,
            "25 % more distance (1,000 m) than the least, for 13 min less lateness: none at all.",
        ),
        (
            [[3000, 2100], [3600, 1800]],
            1,
            [SECONDS, LONGEST],
            PLANS,
            "20 % more driving (10 min) than the least,"
            " and the longest route is 14 % shorter (5 min): the shortest of all plans found.",
        ),
        (
            [[3000, 2100], [3600, 1800]],
            0,
            [SECONDS, LONGEST],
            PLANS,
            "The least driving."
            " Every other plan makes the longest route shorter, for more driving.",
        ),
        (
            [[1, 1, 1]],
            0,
            [METRES, RISK, SECONDS],
            TOURS,
            "This tour is the best found under all objectives.",
        ),
        (
            [[1000, 9, 60], [2000, 3, 90]],
            0,
            [METRES, RISK, SECONDS],
            TOURS,
            "The least distance of all and the least driving of all; 200 % more risk"
            " than the best of each.",
        ),
    ],
)
def test_a_sentence_says_what_a_choice_gives_up_and_gains(
    node: Node,
    lengths: list[list[float]],
    at: int,
    objectives: list[dict[str, Any]],
    noun: dict[str, str],
    said: str,
) -> None:
    tours = front(*lengths)
    assert node.call("result/choice.js", "choiceOf", tours, tours[at], objectives, noun) == said


SPREAD = {"means": [1680, 2], "p90": [2040, 2]}
ON_TIME = {"on_time": 0.94, "duration": 1680, "duration_p90": 2040}
SECONDS = [{"name": "time", "unit": "s"}, {"name": "risk", "unit": "people"}]


def test_lengths_that_spread_say_what_most_days_do_not_exceed(node: Node) -> None:
    said = node.evaluate(
        """async ([objectives, item, plan, percentile]) => {
          const { noteOn } = await import("./page/result/notes.js");
          const { measuresOf } = await import("./page/fleet/measures.js");
          const { compared } = await import("./page/common/amounts.js");
          const asked = { objectives: [{ ...objectives[0], percentile }], clock: "time" };
          const known = { movers: null, asked };
          const rows = measuresOf(plan, objectives, asked);
          return [
            ...[0, 1].map((axis) => noteOn(objectives, axis, item, known)),
            noteOn(objectives, 0, plan, known),
            ...rows.map(({ name, objective: o, value: v }) => `${name}: ${compared(v(plan), o)}`),
          ];
        }""",
        [
            SECONDS,
            {"lengths": [2040, 2], **SPREAD},
            {"lengths": [2040, 2], "measures": ON_TIME},
            90,
        ],
    )
    assert said == [
        "28 min on average; nine days of ten within 34 min",
        "",
        "at most, on 90 days of a hundred",
        "Visits on time, %: 94",
        "Time in all, on average: 28 min",
        "Nine days of ten within: 34 min",
    ]


def test_csv_of_the_page_has_means_and_nine_days_of_ten(node: Node) -> None:
    tour = {"angle": 45, "lengths": [2040, 2], "tour": [0, 1], **SPREAD}
    plan = {"balance": 0, "lengths": [2040, 2], "measures": ON_TIME, "routes": [ROUTE]}
    tours, plans = node.evaluate(
        """async ([objectives, tour, plan]) => {
          const { csv } = await import("./page/result/exports.js");
          const of = (kind, front) => csv({ kind, front: [front] }, { objectives, asked: {} }, 0);
          return [of("front", tour), of("fleet", plan)];
        }""",
        [SECONDS, tour, plan],
    )
    assert tours.splitlines()[0].endswith("mean time (s),p90 time (s),tour,selected")
    assert tours.splitlines()[1] == "45,2040,2,1680,2040,0 1,yes"
    assert ",share of visits on time,mean time in all,p90 time in all,vehicle," in plans
    assert ",2040,2,0.94,1680,2040,van," in plans


ROUTE = {"vehicle": "van", "stops": ["a"], "lengths": [2040, 2]}
