"""Whether a request accepts GeoJSON, by its header `Accept`."""

from collections.abc import Iterator

from starlette.requests import Request

GEOJSON = "application/geo+json"


def accepts_geojson(request: Request) -> bool:
    """Return whether the caller accepts GeoJSON, and prefers it to JSON or has no preference."""
    accept = ",".join(request.headers.getlist("accept"))
    if GEOJSON not in accept.lower():  # most do not name it, and each request asks several times
        return False
    ranges = dict(_media_ranges(accept))
    quality = ranges.get(GEOJSON, 0.0)
    return quality > 0 and quality >= ranges.get("application/json", 0.0)


def _media_ranges(accept: str) -> Iterator[tuple[str, float]]:
    """Yield the media types of an Accept header with their quality (RFC 9110, section 12.5.1)."""
    for each in accept.split(","):
        media, *parameters = (part.strip().lower() for part in each.split(";"))
        quality = next((each[2:] for each in parameters if each.startswith("q=")), "1")
        yield media, _number(quality)


def _number(text: str) -> float:
    """Return a quality as a number; 0 where the text is not a quality."""
    try:
        return float(text)
    except ValueError:
        return 0.0
