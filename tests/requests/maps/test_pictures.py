"""Which shades of a picture are free, occupied or unknown, cell by cell beside the documentation.

The oracle is the text of wiki.ros.org/map_server, one pixel at a time.
"""

import io
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from service.errors import Refusal
from service.requests.maps.pictures import Interpretation, occupancy, read_picture

# The thresholds of the map of TurtleBot3 (ROBOTIS-GIT/turtlebot3, turtlebot3_navigation2/map).
TURTLEBOT: dict[str, Any] = {"occupied_thresh": 0.65, "free_thresh": 0.196}
SHADES = np.arange(256, dtype=np.uint8).reshape(16, 16, 1)


def documented(shade: int, how: Interpretation) -> float:
    """The occupancy of a shade of grey, as the documentation of map_server says."""
    p = shade / 255.0 if how.negate else (255 - shade) / 255.0
    if how.mode == "raw":
        return shade if shade <= 100 else -1
    if p > how.occupied_thresh:
        return 100
    if p < how.free_thresh:
        return -1 if shade == 205 and how.mode == "trinary" else 0
    if how.mode == "trinary":
        return -1
    return 99 * (p - how.free_thresh) / (how.occupied_thresh - how.free_thresh)


@given(
    mode=st.sampled_from(["trinary", "scale", "raw"]),
    negate=st.booleans(),
    thresholds=st.tuples(st.floats(0, 0.49), st.floats(0.5, 1)),
)
def test_greys_mean_what_map_server_documents(
    mode: Any, negate: bool, thresholds: tuple[float, float]
) -> None:
    free, occupied = thresholds
    how = Interpretation(mode=mode, negate=negate, occupied_thresh=occupied, free_thresh=free)
    expected = [documented(shade, how) for shade in range(256)]
    np.testing.assert_allclose(occupancy(SHADES, how).ravel(), expected, atol=0.5 + 1e-9)


def test_what_a_map_saver_writes_is_free_unknown_and_occupied() -> None:
    saved = np.array([[[254], [205], [0]]], np.uint8)
    for free_thresh in (0.196, 0.25):  # of ROS and of Nav2
        how = Interpretation(mode="trinary", occupied_thresh=0.65, free_thresh=free_thresh)
        assert occupancy(saved, how).tolist() == [[0, -1, 100]]


def test_without_a_mode_dark_is_occupied_and_grey_205_unknown() -> None:
    found = occupancy(SHADES, Interpretation()).ravel()
    expected = np.where(np.arange(256) < 128, 100, 0)
    expected[205] = -1
    np.testing.assert_array_equal(found, expected)
    negated = occupancy(SHADES, Interpretation(negate=True)).ravel()
    np.testing.assert_array_equal(negated, np.where(np.arange(256) < 128, 0, 100))


def test_without_a_mode_colours_are_as_dark_as_they_look() -> None:
    rng = np.random.default_rng(0)
    for mode, count in (("RGB", 3), ("RGBA", 4), ("LA", 2)):
        channels = rng.integers(0, 256, (40, 50, count), dtype=np.uint8)
        shades = np.asarray(Image.fromarray(channels, mode).convert("L"))
        expected = np.where(shades < 128, 100, np.where(shades == 205, -1, 0))
        np.testing.assert_array_equal(occupancy(channels, Interpretation()), expected)


@pytest.mark.parametrize("mode", ["trinary", "scale", "raw"])
def test_with_a_mode_colours_are_averaged(mode: Any) -> None:
    rng = np.random.default_rng(1)
    colours = rng.integers(0, 256, (30, 30, 3), dtype=np.uint8)
    colours[..., 2] = -(colours[..., 0].astype(int) + colours[..., 1]) % 3  # the sum is 3 x a shade
    greys = (colours.astype(int).sum(axis=2) // 3).astype(np.uint8)[:, :, np.newaxis]
    how = Interpretation(mode=mode, **TURTLEBOT)
    np.testing.assert_array_equal(occupancy(colours, how), occupancy(greys, how))


@pytest.mark.parametrize(("mode", "unknown"), [("trinary", -1), ("scale", -1), ("raw", 50)])
def test_a_transparent_pixel_is_unknown_but_in_mode_raw(mode: Any, unknown: int) -> None:
    pixels = np.array([[[50, 255], [50, 254], [50, 0]]], np.uint8)
    how = Interpretation(mode=mode, **TURTLEBOT)
    [[opaque, *others]] = occupancy(pixels, how).tolist()
    assert (opaque, others) == (50 if mode == "raw" else 100, [unknown, unknown])


def test_a_picture_is_png_or_pgm() -> None:
    stream = io.BytesIO()
    Image.fromarray(SHADES[:, :, 0]).save(stream, "PNG")
    np.testing.assert_array_equal(read_picture(stream.getvalue(), 256), SHADES)
    pgm = b"P5 16 16 255\n" + SHADES.tobytes()
    np.testing.assert_array_equal(read_picture(pgm, 256), SHADES)


@pytest.mark.parametrize("content", [b"", b"GIF89a", b"P6 1 1 255\n123", b"BM", b"P4 1 1\n1"])
def test_another_format_is_refused(content: bytes) -> None:
    with pytest.raises(Refusal, match="grid must be a PNG or PGM file"):
        read_picture(content, 256)


def test_a_map_of_16_bits_is_read_as_one_of_8() -> None:
    shades = np.array([[0, 100, 205, 255]], np.uint8)
    file = io.BytesIO()
    Image.fromarray(shades.astype(np.uint16) * 257).save(file, "PNG")
    deep = file.getvalue()
    how = Interpretation(mode="trinary", occupied_thresh=0.65, free_thresh=0.25)
    assert occupancy(read_picture(deep, 4), how).tolist() == [[100, -1, -1, 0]]
    np.testing.assert_array_equal(read_picture(deep, 4)[:, :, 0], shades)
