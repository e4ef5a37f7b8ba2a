"""Map tiles: the page is told of them, and browsers may load them, where the settings name any."""

import asyncio

import httpx
import pytest
from pydantic import ValidationError
from starlette.applications import Starlette

from service.api.app import Edge
from service.api.site.tiles import Tiles
from service.settings import Settings

TEMPLATE = "https://{s}.tiles.example.org:8443/streets/{z}/{x}/{y}.png?key=a-b"


def answer_of(tiles: Tiles) -> tuple[object, str]:
    """Return what the page is told of tiles, and the policy beside it."""
    edge = Edge(tiles=tiles)
    app = Starlette(routes=[edge.tiles.route(False, 60.0)], middleware=edge.middleware)

    async def answer() -> httpx.Response:
        async with httpx.AsyncClient(transport=httpx.ASGITransport(app=app)) as client:
            return await client.get("http://service/page/settings.json")

    response = asyncio.run(answer())
    return response.json(), response.headers["content-security-policy"]


def test_the_policy_names_the_server_of_the_tiles() -> None:
    told, policy = answer_of(Tiles(TEMPLATE, "© somebody"))
    assert told == {"tiles": TEMPLATE, "credit": "© somebody", "roads": False, "seconds": 60.0}
    assert "img-src 'self' data: https://*.tiles.example.org:8443; " in policy


def test_without_tiles_images_come_from_the_service_alone() -> None:
    told, policy = answer_of(Tiles())
    assert told == {"tiles": None, "credit": "", "roads": False, "seconds": 60.0}
    assert "img-src 'self' data:; " in policy


def test_the_settings_take_a_template_of_tiles(monkeypatch: pytest.MonkeyPatch) -> None:
    assert Settings().tiles is None
    monkeypatch.setenv("PARETOUR_TILES", TEMPLATE)
    assert Settings().tiles == TEMPLATE


@pytest.mark.parametrize(
    "template",
    [
        "https://tiles.example.org/streets.png",
        "https://tiles.example.org/{z}/{x}.png",
        "https://tiles.example.org/{z}/{x}/{y}/{y}.png",
        "ftp://tiles.example.org/{z}/{x}/{y}.png",
        "https://a b.example.org/{z}/{x}/{y}.png",
        "https://a.example.org; script-src */{z}/{x}/{y}.png",
        "https://{x}.example.org/{z}/{y}.png",
        "//{z}/{x}/{y}.png",
    ],
)
def test_other_templates_are_refused(monkeypatch: pytest.MonkeyPatch, template: str) -> None:
    monkeypatch.setenv("PARETOUR_TILES", template)
    with pytest.raises(ValidationError, match="must be like https"):
        Settings()
