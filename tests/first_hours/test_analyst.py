"""The hour of an analyst: DataFrames go in, and a front, a table and a picture come out."""

from itertools import pairwise
from pathlib import Path

import matplotlib as mpl
import pytest

from tests.first_hours.steps import run_program, says


def test_frames_become_a_front_a_table_a_picture_and_an_order_of_rows(
    released: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(mpl.rcParams, "backend", "agg")
    notebook = run_program("call-it-from-python", "import pandas as pd", tmp_path, released)
    stops, minutes, front = (notebook[name] for name in ("stops", "minutes", "front"))

    says("call-it-from-python", "`front.to_frame()` is a pandas DataFrame with a row for each tour")
    table = front.to_frame()
    assert len(table) == len(front)
    assert {"metres", "minutes"} <= {str(column).split(" ")[0] for column in table.columns}

    says("call-it-from-python", "the last expression of a cell is shown as a chart and a table.")
    shown = front._repr_html_()
    assert "<svg" in shown
    assert "<table" in shown

    says("call-it-from-python", "`front.plot()` draws two or three objectives with matplotlib.")
    front.plot().figure.savefig(tmp_path / "front.png")
    assert (tmp_path / "front.png").read_bytes().startswith(b"\x89PNG")

    says("choose-a-tour", '"At most 10 % longer than the shortest tour" takes two steps')
    shortest = front.choose(balance=0)
    tour = front.choose(first_at_most=1.1 * shortest.lengths[0])
    ordered = stops.iloc[list(tour.tour)]
    assert sorted(ordered["id"]) == sorted(stops["id"])
    ids = [*ordered["id"], ordered["id"].iloc[0]]
    driven = sum(minutes.loc[one, other] for one, other in pairwise(ids))
    assert driven == pytest.approx(tour.lengths[1])
