"""Plans of small fleets against a judge that knows the words of the guide alone."""

import pytest

from tests.fuzz.fleets_judged.attack import judge_many
from tests.helpers.sampled import IS_WHOLE

SEEDS, COUNT = (2, 70) if IS_WHOLE else (1, 40)


@pytest.mark.parametrize("seed", range(SEEDS))
def test_plans_of_fleets_are_as_the_judge_says(seed: int) -> None:
    outcome = judge_many(COUNT, seed)
    assert outcome.faults == []
    assert outcome.counts["enumerated"] > COUNT // 2
    assert outcome.counts["searched"] > 1
