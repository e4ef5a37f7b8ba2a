"""The client reads answers as the service describes them: the same members, of the same types."""

from dataclasses import MISSING, fields
from types import NoneType
from typing import Any, get_args, get_type_hints

import pytest
from paretour import actors, fronts, listing, plans, values
from paretour.ros import paths
from pydantic import BaseModel

from service.api import plan_responses, responses

READ: dict[Any, tuple[type[BaseModel], ...]] = {
    values.Tour: (responses.TourAnswer, responses.CoverageItem),
    values.Uncovered: (responses.UncoveredItem,),
    values.UncoveredRegion: (responses.UncoveredRegionItem,),
    paths.Path: (responses.PathItem,),
    plans.FleetPlan: (plan_responses.PlanItem,),
    plans.FleetRoute: (plan_responses.RouteItem,),
    plans.LeftOut: (plan_responses.LeftOutItem,),
    plans.Reason: (plan_responses.ReasonItem,),
    plans.RobotPlan: (plan_responses.RobotPlanItem,),
    plans.RobotRoute: (plan_responses.RobotRouteItem,),
    fronts.Objective: (responses.ObjectiveName,),
    fronts.RequestNote: (responses.RequestNote,),
    actors.Actor: (responses.ActorItem,),
    listing.ListedFront: (responses.ListedFrontItem,),
}
TYPES = {str: "string", int: "integer", float: "number", bool: "boolean"}
COMPUTED = {"losses"}  # by the client, of all tours and plans


@pytest.mark.parametrize("read", READ, ids=lambda read: read.__name__)
def test_the_client_has_the_members_of_the_answer(read: Any) -> None:
    described, always = {}, set()
    for model in READ[read]:
        schema = model.model_json_schema(mode="serialization")
        described |= schema["properties"]
        always |= set(schema["required"])
    hints = get_type_hints(read)
    assert hints.keys() == described.keys() - COMPUTED
    for field in fields(read):
        of, schema = hints[field.name], described[field.name]
        if of in TYPES:
            assert schema["type"] == TYPES[of]
        has_default = field.default is not MISSING or field.default_factory is not MISSING
        assert has_default or NoneType in get_args(of) or field.name in always
