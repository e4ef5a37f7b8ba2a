"""Lines are decoded as they were encoded, and what is none is refused."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.roads.polyline import decode_polyline
from service.roads.router import Unintelligible
from tests.helpers.fake_router import encode_polyline

MICRO = 10**6
PLACES = st.tuples(
    st.integers(-180 * MICRO, 180 * MICRO).map(lambda micro: micro / MICRO),
    st.integers(-90 * MICRO, 90 * MICRO).map(lambda micro: micro / MICRO),
)


@given(line=st.lists(PLACES))
def test_a_line_is_decoded_as_it_was_encoded(line: list[tuple[float, float]]) -> None:
    decoded = decode_polyline(encode_polyline(line), 6)
    assert list(map(tuple, decoded.tolist())) == line


@given(text=st.text() | st.text(st.characters(min_codepoint=63, max_codepoint=126)))
def test_any_text_is_a_line_on_the_earth_or_refused(text: str) -> None:
    try:
        line = decode_polyline(text, 6)
    except Unintelligible:
        return
    assert all(abs(lon) <= 180 and abs(lat) <= 90 for lon, lat in line)


@pytest.mark.parametrize("text", ["_p~iF", "_p~iF~ps|U_", "~~~~~~~~~~~~~~~~?", "\n", "_p~iF~ps|Ué"])
def test_what_is_no_line_is_refused(text: str) -> None:
    with pytest.raises(Unintelligible):
        decode_polyline(text, 5)
