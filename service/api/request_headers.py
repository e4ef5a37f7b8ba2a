"""Read the request headers that say how to plan and to answer, such as `Prefer` and `Accept`."""

import re
from typing import Any

from starlette.requests import Request

from service.errors import invalid_header
from service.webhooks.targets import MOST_LETTERS, Targets

GEOJSON = "application/geo+json"
TEXT = "text/plain"
# Which headers a page of another origin may send (CORS).
ALLOWED = (
    *("Authorization", "Content-Type", "Idempotency-Key", "Last-Event-ID", "Prefer"),
    "Webhook-Url",
)
_LONGEST_KEY = 255
_KEY = rf"^[!-~]([ -~]{{0,{_LONGEST_KEY - 2}}}[!-~])?$"
# For the OpenAPI document.
PARAMETERS: tuple[dict[str, Any], ...] = (
    {
        "name": "Prefer",
        "in": "header",
        "description": "`respond-async` for 202 at once, with a `Location`",
        "schema": {"type": "string"},
    },
    {
        "name": "Idempotency-Key",
        "in": "header",
        "description": "the same for all repeats of a request, so that it is planned once",
        "schema": {
            "type": "string",
            "minLength": 1,
            "maxLength": _LONGEST_KEY,
            "pattern": _KEY,
        },
    },
    {
        "name": "Webhook-Url",
        "in": "header",
        "description": "where to post that the job has ended, signed as Standard Webhooks says;"
        " only with `respond-async`, and only to hosts that the operator allows",
        "schema": {"type": "string", "format": "uri", "maxLength": MOST_LETTERS},
    },
)


def prefers_async(request: Request) -> bool:
    """Return whether the caller wants 202 at once and the front later (RFC 7240)."""
    preferences = ",".join(request.headers.getlist("prefer")).lower().split(",")
    return "respond-async" in (each.partition(";")[0].strip() for each in preferences)


def idempotency_key(request: Request) -> str | None:
    """Return the idempotency key, which repeats of the request share; None without one.

    Raises:
        Refusal: The key is empty, too long, or not printable ASCII.
    """
    key = request.headers.get("idempotency-key")
    if key is not None and re.fullmatch(_KEY, key) is None:
        code = "key-length" if key.isascii() and key.isprintable() else "key-characters"
        raise invalid_header("Idempotency-Key", code, limit=_LONGEST_KEY, came=len(key))
    return key


def webhook_url(request: Request, targets: Targets) -> str | None:
    """Return where the end of the job is to be posted; None where the request does not say.

    Raises:
        Refusal: It is not an address, the operator does not allow it, or there will be no job.
    """
    url = request.headers.get("webhook-url")
    if url is None:
        return None
    if not prefers_async(request):
        raise invalid_header("Webhook-Url", "not-async")
    targets.check(url)
    return url


def accepts_geojson(request: Request) -> bool:
    """Return whether the caller accepts GeoJSON, and prefers it to JSON or has no preference."""
    weights = _weights(request, "accept")
    quality = weights.get(GEOJSON, 0.0)
    return quality > 0 and quality >= weights.get("application/json", 0.0)


def prefers_text(request: Request) -> bool:
    """Return whether the caller prefers plain text to JSON, to anything, and to GeoJSON.

    Libraries that accept JSON, text and anything alike get JSON.
    """
    weights = _weights(request, "accept")
    others = ("application/json", GEOJSON, "application/*", "*/*")
    return weights.get(TEXT, 0.0) > max(weights.get(each, 0.0) for each in others)


def accepts_gzip(request: Request) -> bool:
    """Return whether a request names gzip, or all, in `Accept-Encoding`, with a weight above 0."""
    weights = _weights(request, "accept-encoding")
    return weights.get("gzip", weights.get("*", 0.0)) > 0


def _weights(request: Request, header: str) -> dict[str, float]:
    """Return the items of a header in lower case, each with its weight (RFC 9110, section 12.4.2).

    The weight is 0 where it is not a number.
    """
    weights = {}
    for item in ",".join(request.headers.getlist(header)).lower().split(","):
        name, *parameters = (part.strip() for part in item.split(";"))
        quality = next((each[2:] for each in parameters if each.startswith("q=")), "1")
        try:
            weights[name] = float(quality)
        except ValueError:
            weights[name] = 0.0
    return weights
