"""The benchmark of stops by road: its table, and what does not hold."""

from tests.benchmarks import roads


def test_medians_are_held_against_what_is_asked_for() -> None:
    quick = {"matrices": 0.4, "answer": 1.4, "again": 0.0}
    slow = {"matrices": 3.1, "answer": 4.2, "again": 0.0}
    results = {"rounds": 3, "stops": {"60": [quick, slow, quick], "200": [slow, slow, quick]}}
    assert "| 60 | 0.40 s (3.10 s) | 1.40 s (4.20 s) | 0.00 s (0.00 s) | 3 |" in (
        roads.roads_table(results)
    )
    assert roads.unmet(results) == [
        "matrices of 200 stops must be there within 3 s, got 3.10 s",
    ]
