"""Lines of GeoJSON go through their positions, and are cut at longitude 180."""

from itertools import pairwise
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from pydantic_core import from_json

from service.api.geojson.features import encode_line

LONGITUDES = st.one_of(st.floats(-180, 180), st.sampled_from([-180.0, 179.5, -179.5, 180.0, 0.0]))
WAYS = st.lists(st.tuples(LONGITUDES, st.floats(-90, 90)), min_size=2, max_size=8)


def _lines(way: list[tuple[float, float]]) -> list[Any]:
    geometry = from_json(encode_line(np.array(way)))
    assert (geometry["type"] == "LineString") == isinstance(geometry["coordinates"][0][0], float)
    return (
        [geometry["coordinates"]] if geometry["type"] == "LineString" else geometry["coordinates"]
    )


@given(WAYS)
def test_no_line_goes_more_than_half_way_round_the_earth(way: list[tuple[float, float]]) -> None:
    lines = _lines(way)
    assert len(lines) == 1 + sum(abs(b[0] - a[0]) > 180 for a, b in pairwise(way))
    assert all(len(line) > 1 for line in lines)
    assert all(abs(b[0] - a[0]) <= 180 for line in lines for a, b in pairwise(line))
    visited = [lines[0][0]]
    for number, line in enumerate(lines):
        last = number == len(lines) - 1
        visited += line[1:] if last else line[1:-1]
        if not last:
            (end, latitude), (begin, same) = line[-1], lines[number + 1][0]
            assert (abs(end), begin, same) == (180, -end, latitude)
    assert visited == [list(place) for place in way]


def test_a_step_over_longitude_180_is_cut_where_it_crosses() -> None:
    assert from_json(encode_line(np.array([(179.0, 10.0), (-178.0, 16.0)]))) == {
        "type": "MultiLineString",
        "coordinates": [[[179.0, 10.0], [180.0, 12.0]], [[-180.0, 12.0], [-178.0, 16.0]]],
    }


def test_a_line_longer_than_is_written_at_once_is_whole() -> None:
    way = np.random.default_rng(1).uniform(-90, 90, (40_000, 2))
    assert from_json(encode_line(way))["coordinates"] == way.tolist()
