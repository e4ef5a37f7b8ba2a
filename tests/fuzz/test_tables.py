"""Mutated tables from a seed: no row vanishes, and no column is unused without a note."""

from tests.fuzz.tables import tried
from tests.helpers.sampled import third

COUNT = third(400)


def test_no_row_vanishes_and_no_column_is_unused_without_a_note() -> None:
    outcomes, faults = tried(COUNT)
    assert not faults
    assert outcomes["read"] > COUNT // 5
    assert outcomes["refused"] > COUNT // 5
