"""The help of the functions that plan: it says what each member of their requests is."""

from collections.abc import Callable
from pydoc import plain, render_doc
from typing import Any

import paretour
import pytest
from paretour import AsyncClient, Client
from pydantic import BaseModel

from service.requests.coverage import CoverageRequest
from service.requests.fleet import FleetRequest
from service.requests.fleet_fields import VehicleItem
from service.requests.front import FrontRequest
from service.requests.replan.fields import ReplanRequest
from service.requests.replan.fleet_fields import ReplanFleetRequest
from service.requests.replan.offers import OffersRequest


def help_on(function: Callable[..., Any]) -> str:
    return " ".join(plain(render_doc(function)).split())


@pytest.mark.parametrize(
    ("function", "request_model"),
    [
        (Client.front, FrontRequest),
        (AsyncClient.front, FrontRequest),
        (Client.submit, FrontRequest),
        (paretour.plan, FrontRequest),
        (Client.fleet, FleetRequest),
        (paretour.plan_fleet, FleetRequest),
        (Client.robots, CoverageRequest),
        (paretour.plan_robots, CoverageRequest),
        (Client.replan, ReplanRequest),
        (paretour.replan, ReplanRequest),
        (Client.replan_fleet, ReplanFleetRequest),
        (paretour.replan, ReplanFleetRequest),
        (Client.offers, OffersRequest),
        (paretour.offer_slots, OffersRequest),
    ],
)
def test_the_help_says_what_each_member_of_the_request_is(
    function: Callable[..., Any], request_model: type[BaseModel]
) -> None:
    text = help_on(function)
    for name, field in request_model.model_fields.items():
        assert f" {name}: {field.description} " in f"{text} "


def test_the_help_says_what_members_inside_members_are() -> None:
    text = help_on(Client.fleet)
    for name, field in VehicleItem.model_fields.items():
        assert f" vehicles.{name}: {field.description} " in text


def test_the_help_on_a_map_for_one_robot_does_without_the_members_for_several() -> None:
    for function in (Client.coverage, paretour.plan_coverage):
        text = help_on(function)
        assert " cell_size: " in text
        assert " robots: " not in text
