"""Describe the headers of answers: in the OpenAPI document, and to pages of other origins."""

from typing import Any

_RATE = ("RateLimit", "RateLimit-Policy")
_REPLAYED = "Idempotent-Replayed"
REPLAYED = (_REPLAYED.lower().encode(), b"true")
# Which headers a page of another origin may read (CORS).
EXPOSED = (
    *(_REPLAYED, "Link", "Location", "Preference-Applied"),
    *(*_RATE, "Retry-After", "X-Request-ID"),
)
_RATE_LIMITED = "429"
_REPLAYABLE = {"200", "202"}  # the statuses of answers to repeats that are described
_UNCOUNTED = ("401",)  # statuses of requests that are refused before they are counted

HEADERS: dict[str, dict[str, Any]] = {
    _REPLAYED: {
        "description": "`true` on the answer to a repeat with the same `Idempotency-Key`: its front"
        " is that of the first request",
        "schema": {"type": "string", "enum": ["true"]},
    },
    "RateLimit": {
        "description": "how many requests may follow at once (r), and in how many seconds there"
        " will be more (t); only while requests are counted"
        " (draft-ietf-httpapi-ratelimit-headers)",
        "schema": {"type": "string", "examples": ['"default";r=998;t=41']},
    },
    "RateLimit-Policy": {
        "description": "how many requests (q) in how many seconds (w) one client may make",
        "schema": {"type": "string", "examples": ['"default";q=1000;w=60']},
    },
}
LINK: dict[str, dict[str, Any]] = {
    "Link": {
        "description": 'the address of the next page, with rel="next"; left out on the last (RFC'
        " 8288)",
        "schema": {"type": "string"},
    }
}


def add_headers(operation: dict[str, Any]) -> None:
    """Name the headers of an operation's responses, where HEADERS describes them."""
    responses = operation["responses"]
    if any(each["name"] == "Idempotency-Key" for each in operation.get("parameters", ())):
        for status in _REPLAYABLE & responses.keys():
            _add(responses[status], (_REPLAYED,))
    if _RATE_LIMITED not in responses:  # the operation is open to all, without a rate
        return
    for status, response in responses.items():
        if status not in _UNCOUNTED:
            _add(response, _RATE)


def _add(response: dict[str, Any], names: tuple[str, ...]) -> None:
    headers = response.setdefault("headers", {})
    headers |= {name: {"$ref": f"#/components/headers/{name}"} for name in names}
