"""The schemas of front requests: one for each form, under the limits of the service."""

from dataclasses import replace
from typing import Any

import pytest

from service.requests.json_schemas import FILE_FORMS, JSON_FORMS, fleet_schemas, front_schemas
from tests.helpers.serving import LIMITS

SCHEMAS = front_schemas(LIMITS, ["pa-one"])
CITIES = ("coordinates", "matrices", "stops", "objectives")


@pytest.mark.parametrize(
    ("form", "members"),
    [
        ("CoordinatesRequest", ["coordinates"]),
        ("MatricesRequest", ["matrices"]),
        ("StopsRequest", ["stops", "objectives"]),
        ("MatricesFileRequest", []),
        ("StopsFileRequest", ["stops", "objectives"]),
    ],
)
def test_a_form_requires_what_it_is_of_and_has_no_other(form: str, members: list[str]) -> None:
    schema = SCHEMAS[form]
    assert schema["title"] == form
    assert schema["required"] == members
    assert [name for name in CITIES if name in schema["properties"]] == members
    assert {"time_limit", "start", "seed"} < schema["properties"].keys()
    assert schema["additionalProperties"] is False


def test_every_form_is_there_and_every_reference_leads_to_a_schema() -> None:
    assert {*JSON_FORMS, *FILE_FORMS} < SCHEMAS.keys()
    names = {reference.rsplit("/", 1)[-1] for reference in references(SCHEMAS)}
    assert names == SCHEMAS.keys() - {*JSON_FORMS, *FILE_FORMS}


def test_an_id_may_stand_for_an_index_among_stops_alone() -> None:
    def types(form: str) -> list[Any]:
        for end in ("start", "end"):
            reference, null = SCHEMAS[form]["properties"][end]["anyOf"]
            assert null == {"type": "null"}
        return [each["type"] for each in reference.get("oneOf", [reference])]

    assert types("StopsRequest") == types("StopsFileRequest") == ["integer", "string"]
    assert types("CoordinatesRequest") == types("MatricesRequest") == ["integer"]


def test_an_objective_has_one_source() -> None:
    kinds = {"MatrixObjective": "matrix", "PlaneObjective": "coordinates"}
    for name, source in {**kinds, "MeasuredObjective": "from"}.items():
        assert SCHEMAS[name]["required"] == ["name", source]
        speed = {"speed"} if source == "from" else set()
        members = {"name", "unit", source, "over_the_day", *speed}
        assert SCHEMAS[name]["properties"].keys() == members
    assert SCHEMAS["NamedObjective"]["properties"].keys() == {"name", "unit", "over_the_day"}
    assert SCHEMAS["SlicesObjective"]["properties"].keys() == {"name", "unit", "slices"}


def test_the_schema_has_traffic_where_the_routing_engine_has() -> None:
    limits = replace(LIMITS, roads=True, traffic=True)
    schemas = front_schemas(limits, ["pa-one"])
    measured = schemas["MeasuredObjective"]
    reference, _ = measured["properties"]["traffic"]["anyOf"]
    assert reference == {"$ref": "#/components/schemas/TrafficItem"}
    assert measured["dependentSchemas"]["traffic"]["properties"]["from"] == {"const": "road_time"}
    assert schemas["TrafficItem"]["required"] == ["date", "at"]
    assert "traffic" not in schemas["MatrixObjective"]["properties"]
    assert "traffic" not in schemas["SlicesObjective"]["properties"]


def test_the_schema_says_which_speeds_there_are() -> None:
    schemas = {**SCHEMAS, **fleet_schemas(LIMITS)}
    for name in ("MeasuredObjective", "FleetMeasuredObjective"):
        speed, _ = schemas[name]["properties"]["speed"]["anyOf"]
        assert speed == {"type": "number", "minimum": 0.001, "maximum": 1000}
        needs = schemas[name]["dependentSchemas"]["speed"]
        assert needs == {"properties": {"from": {"const": "great_circle"}}}
        assert "dependentSchemas" not in schemas[name.replace("Measured", "Matrix")]


@pytest.mark.parametrize(
    ("roads", "measures"),
    [(False, ["great_circle"]), (True, ["great_circle", "road_time", "road_distance"])],
)
def test_roads_are_shown_where_there_is_a_routing_engine(roads: bool, measures: list[str]) -> None:
    schemas = front_schemas(replace(LIMITS, roads=roads), ["pa-one"])
    assert schemas["MeasuredObjective"]["properties"]["from"]["enum"] == measures


def test_the_schemas_have_the_limits_and_the_actors() -> None:
    for form, member in zip(JSON_FORMS, ("coordinates", "matrices", "stops"), strict=True):
        fields = SCHEMAS[form]["properties"]
        rows = fields[member]["items"] if member == "matrices" else fields[member]
        assert rows["maxItems"] == LIMITS.cities
        assert fields["actor"]["enum"] == ["pa-one"]
        assert fields["repairs"]["maximum"] == LIMITS.repairs
        assert "default" not in fields["repairs"]  # it depends on the time limit
        assert fields["augment"]["deprecated"] is True


def references(value: Any) -> set[str]:
    """All references in a schema."""
    if isinstance(value, list):
        return set().union(*map(references, value))
    if not isinstance(value, dict):
        return set()
    own = {value["$ref"]} if "$ref" in value else set()
    return own.union(*map(references, value.values()))
