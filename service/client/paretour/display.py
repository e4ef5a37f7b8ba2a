"""Show a front in a notebook: a sentence, and HTML with a chart in SVG and a table, no script."""

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray
from paretour.choice import losses

Array = NDArray[np.float64]
_MOST_ROWS = 12  # of a table
_MOST_POINTS = 200  # of a chart
_LONGEST = 40  # characters of a name
_WIDTH, _HEIGHT, _MARGIN = 420, 260, 44  # of a chart, in pixels
_COLOUR = "#0072b2"
_TEXT = 'font-size="11" fill="currentColor"'
_CELL = 'style="text-align: right; padding: 2px 10px"'


def summary(counted: str, labels: Sequence[str], lengths: Array, *more: str) -> str:
    """Return a line about a front: the number of its items, and the range of each length."""
    ranges = [
        f"{shown(label)} {least:.6g} to {greatest:.6g}"
        for label, least, greatest in zip(labels, *_ends(lengths), strict=False)
    ]
    return "; ".join((counted, *ranges, *more))


def shown(text: str) -> str:
    """Return a text in one line of bounded length."""
    line = "".join(each if each.isprintable() else "?" for each in text)
    return line if len(line) <= _LONGEST else f"{line[: _LONGEST - 1]}…"


def counted(count: int, noun: str) -> str:
    """Return a number of things, as "1 tour" or "2 tours"."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def numbers(values: Array) -> str:
    """Return numbers in one line."""
    return ", ".join(f"{value:.6g}" for value in values)


def page(
    sentence: str, labels: Sequence[str], lengths: Array, columns: Mapping[str, Sequence[Any]]
) -> str:
    """Return HTML about a front.

    Args:
        sentence: What stands above the chart.
        lengths: The lengths of each item, shape (k, m).
        columns: Further numbers of each item, by heading.
    """
    parts = [f"<p>{escape(sentence)}</p>"]
    if len(lengths):
        parts += [_chart(labels, lengths), _table(labels, lengths, columns)]
    return f"<div>{''.join(parts)}</div>"


def _table(labels: Sequence[str], lengths: Array, columns: Mapping[str, Sequence[Any]]) -> str:
    rows = _spread(len(lengths), _MOST_ROWS)
    headings = "".join(
        f"<th {_CELL}>{escape(shown(each))}</th>" for each in ("", *labels, *columns)
    )
    body = "".join(
        f"<tr><th {_CELL}>{row}</th>"
        + "".join(f"<td {_CELL}>{value:.6g}</td>" for value in lengths[row])
        + "".join(f"<td {_CELL}>{values[row]:.4g}</td>" for values in columns.values())
        + "</tr>"
        for row in rows
    )
    few = f"<caption>{len(rows)} of {len(lengths)}</caption>" if len(rows) < len(lengths) else ""
    return f"<table>{few}<thead><tr>{headings}</tr></thead><tbody>{body}</tbody></table>"


def _chart(labels: Sequence[str], lengths: Array) -> str:
    """Return a chart in SVG: points under two objectives, and a line for each item under more."""
    draw = _points if lengths.shape[1] == 2 else _lines
    box = f'width="{_WIDTH}" height="{_HEIGHT}" viewBox="0 0 {_WIDTH} {_HEIGHT}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {box} role="img">{draw(labels, lengths)}</svg>'


def _points(labels: Sequence[str], lengths: Array) -> str:
    """Draw a point for each item, the first length to the right and the second one up."""
    across, up = (escape(shown(label)) for label in labels)
    low, high = ([f"{each:.4g}" for each in ends] for ends in _ends(lengths))
    left, right, top, bottom = _MARGIN + 20, _WIDTH - 12, 24, _HEIGHT - _MARGIN
    points = _within(lengths, (left + 8, bottom - 8), (right - 8, top + 8))
    circles = "".join(
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{_COLOUR}">'
        f"<title>{row}: {numbers(lengths[row])}</title></circle>"
        for row, (x, y) in ((row, points[row]) for row in _spread(len(points), _MOST_POINTS))
    )
    return (
        f'<path d="M{left} {top}V{bottom}H{right}" fill="none" stroke="currentColor"/>'
        f'<text x="{left + 8}" y="{bottom + 16}" {_TEXT}>{low[0]}</text>'
        f'<text x="{right}" y="{bottom + 16}" text-anchor="end" {_TEXT}>{high[0]}</text>'
        f'<text x="{(left + right) / 2}" y="{_HEIGHT - 10}" text-anchor="middle" {_TEXT}>{across}'
        f'</text><text x="{left - 6}" y="{bottom - 4}" text-anchor="end" {_TEXT}>{low[1]}</text>'
        f'<text x="{left - 6}" y="{top + 12}" text-anchor="end" {_TEXT}>{high[1]}</text>'
        f'<text x="4" y="14" {_TEXT}>{up}</text>{circles}'
    )


def _lines(labels: Sequence[str], lengths: Array) -> str:
    """Draw an upright axis for each objective, and a line through the lengths of each item."""
    top, bottom = 36, _HEIGHT - 28
    across = np.linspace(_MARGIN + 16, _WIDTH - _MARGIN - 16, len(labels))
    heights = bottom - losses(lengths) * (bottom - top)
    lines = "".join(
        f'<polyline points="{_joined(across, heights[row])}" fill="none" stroke="{_COLOUR}" '
        f'stroke-opacity="0.5"><title>{row}: {numbers(lengths[row])}</title></polyline>'
        for row in _spread(len(lengths), _MOST_POINTS)
    )
    axes = "".join(
        f'<path d="M{x:.1f} {top}V{bottom}" stroke="currentColor"/>'
        f'<text x="{x:.1f}" y="14" text-anchor="middle" {_TEXT}>{escape(shown(label))}</text>'
        f'<text x="{x:.1f}" y="{top - 6}" text-anchor="middle" {_TEXT}>{high:.4g}</text>'
        f'<text x="{x:.1f}" y="{bottom + 16}" text-anchor="middle" {_TEXT}>{low:.4g}</text>'
        for x, label, low, high in zip(across, labels, *_ends(lengths), strict=True)
    )
    return lines + axes


def _joined(across: Array, heights: Array) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(across, heights, strict=True))


def _within(lengths: Array, low: tuple[float, float], high: tuple[float, float]) -> Array:
    """Return points moved and scaled so that they fill a box between two of its corners."""
    return np.array(low) + losses(lengths) * (np.array(high) - low)


def _ends(lengths: Array) -> tuple[Array, Array]:
    """Return the least and the greatest length under each objective; none of an empty front."""
    return (
        (lengths.min(axis=0), lengths.max(axis=0)) if len(lengths) else (lengths[:0], lengths[:0])
    )


def _spread(count: int, most: int) -> list[int]:
    """Return numbers below a count, evenly spread, with the first and the last."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int)).tolist()
