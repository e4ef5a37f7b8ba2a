"""The request headers that change how a front is planned: `Prefer` and `Idempotency-Key`."""

import re
from typing import Any

from starlette.requests import Request

from service.errors import Fault, Refusal

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
        "description": "what repeats of this request have in common, so that it is done once",
        "schema": {
            "type": "string",
            "minLength": 1,
            "maxLength": _LONGEST_KEY,
            "pattern": _KEY,
        },
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
        such = "" if key.isascii() and key.isprintable() else ", some of them others"
        sentence = (
            f"Idempotency-Key must have 1 to {_LONGEST_KEY} characters of printable ASCII, "
            f"got {len(key)}{such}"
        )
        raise Refusal("invalid-request", detail=sentence, errors=[Fault(sentence)])
    return key
