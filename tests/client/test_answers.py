"""Every surface has the members of answers that are declared: the service, OpenAPI, the client.

The answers here have every member that is declared but those in `RARE`, or a test fails.
"""

import json
from collections.abc import Iterator
from dataclasses import fields
from typing import Any

import httpx
import pytest
from paretour import Tour
from paretour.described import SCHEMAS, document_of, name_of, sentence_on
from paretour.expect import members, value_of
from paretour.kinds import parse_any
from paretour.listing import ListedFront
from paretour.offers import parse_offers
from paretour.questions import Option
from paretour.values import parse_tour

from service.kinds.offers import answer_offers
from service.kinds.offers import parse_offers as offers_task
from service.requests.replan.way import ReplanSource
from tests.helpers.offers import HOUR, LIMITS, NEW_PLACE, NINE, as_stored, stored_fleet
from tests.helpers.offers import fleet_request as fleet_by_hand
from tests.helpers.serving import app_of, serving

Answers = dict[str, Any]
Member = tuple[str, str]  # the name of a schema, and that of a member
SIX = range(6)
LEGS = [[float(1 + (3 * i + 5 * j) % 7) for j in SIX] for i in SIX]
PLANE = [[float(i % 3), float(i * i % 5)] for i in SIX]
STOPS = [{"id": f"s{i}", "location": [24.9 + i / 100, 60.1 + i % 2 / 100]} for i in SIX]
SWAPPED = [*STOPS[:5], {"id": "s5", "location": [60.1, 24.95]}]
TWO: list[dict[str, Any]] = [
    {"name": "time", "unit": "s", "matrix": LEGS},
    {"name": "way", "coordinates": PLANE},
]
DAY = [{**TWO[0], "over_the_day": [[0, 1.0], [36000, 2.0]]}, TWO[1]]
SPREAD = [{**TWO[0], "spread": 0.3}, TWO[1]]
WALL = [[0, 0, 1, 0], [0, 0, 1, 0], [0, 0, 1, 1]]  # the cells to its right are out of reach
MAP: dict[str, Any] = {
    "grid": WALL,
    "cell_size": 0.5,
    "origin": [1.0, 2.0, 0.0],
    "places": [[0, 0], [2, 1], [2, 0]],
    "paths": True,
}
NIGHT = {"robot_speed": 0.5, "departure": 0, "over_the_day": [[[0, 2.0]]]}
VAN = {"id": "van", "count": 2, "start": "s0", "end": "s0", "capacity": [3], "profile": "van"}
FLEET: dict[str, Any] = {
    "stops": [
        STOPS[0],
        *({**each, "demand": [1]} for each in STOPS[1:4]),
        {**STOPS[4], "demand": [1], "prize": 0.1},
        {**STOPS[5], "prize": 0.1, "skills": ["crane"]},
    ],
    "objectives": [TWO[0], {"name": "way", "matrices": [{"profile": "van", "matrix": LEGS}]}],
    "vehicles": [{**VAN, "shifts": [[0, 900], [1000, 1900]]}],
    "clock": "time",
}
# The one vehicle is on its way from 10 to 30 at least, and takes its break.
DRIVEN = {
    **FLEET,
    "stops": [
        STOPS[0],
        {**STOPS[1], "window": [0, 10], "demand": [1]},
        {**STOPS[2], "window": [30, 40], "demand": [1]},
        {**STOPS[3], "prize": 0.1, "demand": [1]},
    ],
    "objectives": [
        {**TWO[0], "matrix": [row[:4] for row in LEGS[:4]]},
        {"name": "left", "measure": "unassigned"},
        {"name": "way", "coordinates": PLANE[:4]},
    ],
    "vehicles": [
        {
            "id": "van",
            "start": "s0",
            "shift": [0, 900],
            "capacity": [9],
            "max_distance": 99,
            "max_driving": 99,
            "breaks": [{"window": [15, 20], "length": 1}],
        }
    ],
    "time_limit": 0.2,
}
ASKED: dict[str, tuple[str, dict[str, Any]]] = {
    "cities": ("/front", {"matrices": [LEGS, LEGS[::-1]]}),
    "stops": ("/front", {"stops": STOPS, "objectives": TWO, "arrivals": True}),
    "three": ("/front", {"coordinates": [[*each, *each[::-1], 1.0, each[0]] for each in PLANE]}),
    "open": ("/front", {"stops": SWAPPED, "objectives": TWO, "closed": False}),
    "day": ("/front", {"stops": STOPS, "objectives": DAY, "departure": 35990}),
    "spread": ("/front", {"stops": STOPS, "objectives": SPREAD}),
    "coverage": ("/coverage", {**MAP, "second_matrix": [row[:3] for row in LEGS[:3]]}),
    "robots": ("/coverage", {**MAP, **NIGHT, "robots": [{"id": "a"}, {"id": "b", "start": 2}]}),
    "fleet": ("/fleet", FLEET),
    "driven": ("/fleet", DRIVEN),
}
SCHEMA_OF = {"front": "FrontAnswer", "coverage": "CoverageAnswer", "fleet": "FleetAnswer"}
SCHEMA_OF |= {"robots": "RobotsAnswer"}
FRONTS = set(SCHEMA_OF.values())
TOURS = {"TourItem", "CoverageItem", "TourAnswer"}
pytestmark = pytest.mark.usefixtures("compiled")

# Of fronts that failed, of what a busy machine has no time for, and of several shifts.
RARE = {
    *((name, "problem") for name in FRONTS),
    *(("LeftOutItem", "plan"), ("LeftOutItem", "price"), ("OfferItem", "complete")),
    ("ChoiceItem", "shift"),
}
DRAWN = {"front", "names", "units", "plan", "plan_lengths"}  # beside what items have


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    with serving(app_of()) as address:
        yield address


@pytest.fixture(scope="module")
def schemas(url: str) -> dict[str, Any]:
    found: dict[str, Any] = httpx.get(f"{url}/openapi.json").json()["components"]["schemas"]
    return found


@pytest.fixture(scope="module")
def fronts(url: str) -> Answers:
    found = {name: _post(url, path, body) for name, (path, body) in ASKED.items()}
    rest = {
        "stops": {"done": ["s0"]},
        "fleet": {"plan": 0, "now": 5, "routes": [{"route": 0, "done": []}]},
    }
    for name, changes in rest.items():
        path = f"/front/{found[name]['id']}/replan"
        found[f"rest of {name}"] = _post(url, path, changes)
    return found


@pytest.fixture(scope="module")
def others(url: str, fronts: Answers) -> Answers:
    """Further answers, by schema."""
    order = {"id": "new", "location": NEW_PLACE, "demand": [1]}
    body = json.dumps({"order": order, "slots": [[NINE, NINE + HOUR], [0, 60]]}).encode()
    source = ReplanSource(body, as_stored(stored_fleet(fleet_by_hand())))
    offers = answer_offers(offers_task(source, LIMITS, {}), LIMITS, {})
    return {
        "OffersAnswer": json.loads(offers),
        "ActorsAnswer": httpx.get(f"{url}/actors").json(),
        "FrontsAnswer": httpx.get(f"{url}/front").json(),
        **{
            f"TourAnswer of {name}": _get(url, "/tour", front=fronts[name]["id"], knee=True)
            for name in ("stops", "coverage", "three")
        },
        **{f"QuestionAnswer {number}": each for number, each in enumerate(_asked(url, fronts))},
    }


def _asked(url: str, fronts: Answers) -> Iterator[Any]:
    """Yield the questions about a front of tours and one of plans, with those at their ends."""
    for name in ("three", "fleet"):
        question, picks = {"left": 1}, list[str]()
        while question["left"]:
            path = f"/front/{fronts[name]['id']}/questions"
            question = _get(url, path, **({"picks": ",".join(picks)} if picks else {}))
            picks.append("0")
            yield question


def _post(url: str, path: str, body: dict[str, Any]) -> Any:
    answer = httpx.post(f"{url}{path}", json={"time_limit": 0, **body}, timeout=300)
    assert answer.status_code == 200, answer.text
    return answer.json()


def _get(url: str, path: str, **query: Any) -> Any:
    return httpx.get(f"{url}{path}", params=query).json()


def met(name: str, value: Any, schemas: dict[str, Any], where: str) -> Iterator[Member]:
    """Yield each member of an object that its schema has too; fail at any other difference."""
    schema = schemas[name]
    assert isinstance(value, dict), where
    assert value.keys() <= schema["properties"].keys(), where
    assert set(schema.get("required", ())) <= value.keys(), where
    for member, each in value.items():
        yield name, member
        yield from inside(schema["properties"][member], each, schemas, f"{where}/{member}")


def inside(schema: Any, value: Any, schemas: dict[str, Any], where: str) -> list[Member]:
    """Return the members of the objects in a value, which must be as its schema says."""
    if "anyOf" in schema:
        for choice in schema["anyOf"]:
            try:
                return inside(choice, value, schemas, where)
            except AssertionError:
                continue
        raise AssertionError(f"{where} fits nothing")
    if "$ref" in schema:
        return [*met(schema["$ref"].rpartition("/")[2], value, schemas, where)]
    kinds: dict[str, Any] = {
        "integer": int,
        "number": (int, float),
        "string": str,
        "null": type(None),
    }
    kinds |= {"boolean": bool, "array": list, "object": dict}
    assert isinstance(value, kinds.get(schema.get("type", ""), object)), where
    assert value in schema.get("enum", [value]), where
    if schema.get("type") != "array":
        return []
    assert schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)), where
    return [
        each for item in value for each in inside(schema.get("items", {}), item, schemas, where)
    ]


def test_the_service_writes_what_openapi_has_and_openapi_has_nothing_else(
    fronts: Answers, others: Answers, schemas: dict[str, Any]
) -> None:
    found: set[Member] = set()
    for name, front in fronts.items():
        found |= set(met(SCHEMA_OF[front["kind"]], front, schemas, name))
    for name, answer in others.items():
        found |= set(met(name.partition(" ")[0], answer, schemas, name))
    shown = set(SCHEMAS.values())
    declared = {(name, each) for name in shown for each in schemas[name]["properties"]}
    unmet = declared - found
    for alike in (FRONTS, TOURS):  # each adds members to those of another
        of_some = {each for name, each in found if name in alike}
        unmet -= {(name, each) for name in alike for each in of_some}
    assert unmet <= RARE, sorted(unmet - RARE)


def test_the_client_reads_every_member_of_tours_and_plans(fronts: Answers) -> None:
    for document in fronts.values():
        front = parse_any(document)
        assert len(front) == len(document["front"])
        for read, item in zip(front, document["front"], strict=True):
            given = {"front": front.id, **item} if isinstance(read, Tour) else item
            for each in given.get("left_out", ()):
                if not each.get("reasons", True):  # there was no time to find any
                    del each["reasons"]
            assert document_of(read) == given


def test_the_client_reads_every_member_of_other_answers(others: Answers) -> None:
    given = others["OffersAnswer"]
    offers = document_of(parse_offers(members(given, "answer")))
    assert offers.pop("document") == given
    assert offers == given
    for name, answer in others.items():
        if name.startswith("TourAnswer"):
            assert document_of(parse_tour(answer)) == answer
        if name.startswith("QuestionAnswer"):
            options = [value_of(Option)(each, name) for each in answer["options"]]
            assert [document_of(each) for each in options] == answer["options"]
    for each in others["FrontsAnswer"]["fronts"]:
        read = document_of(value_of(ListedFront)(each, "front"))
        assert {**read, "stored_at": each["stored_at"]} == each


def test_the_client_reads_every_member_of_fronts(fronts: Answers) -> None:
    for document in fronts.values():
        front = parse_any(document)
        named = {name_of(each): each.name for each in fields(front) if name_of(each)}
        assert document.keys() <= named.keys()
        for name in document.keys() - {"front", "actor"}:  # tours are read all at once
            assert document_of(getattr(front, named[name])) == document[name]
        assert front.actor == (document["actor"] or {}).get("name")


def test_drawn_tours_and_routes_have_their_members(url: str, fronts: Answers) -> None:
    for name in ("stops", "fleet"):
        accept = {"Accept": "application/geo+json"}
        drawn = httpx.get(f"{url}/front/{fronts[name]['id']}", headers=accept).json()["features"]
        items = fronts[name]["front"]
        routes = [each for item in items for each in item.get("routes", [item])]
        assert len(drawn) >= len(routes) > 0  # stops come after routes
        for feature, route in zip(drawn, routes, strict=False):
            shown = feature["properties"].keys() - DRAWN - {"balance", "losses"}
            assert shown == route.keys() - {"tour", "balance", "losses"}


def test_help_has_every_member_with_its_sentence() -> None:
    for cls in SCHEMAS:
        shown = " ".join((cls.__doc__ or "").partition("Attributes:")[2].split())
        assert sentence_on(cls)
        for each in fields(cls):  # type: ignore[arg-type]
            sentence = each.metadata.get("sentence", "")
            said = f"{each.name}: {sentence[:1].upper()}{sentence[1:]}" if sentence else each.name
            assert said in shown
