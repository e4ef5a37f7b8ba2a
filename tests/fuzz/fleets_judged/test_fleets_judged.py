"""Plans of small fleets against a judge that knows the words of the guide alone."""

import pytest

from tests.fuzz.fleets_judged.attack import judge_many
from tests.helpers.sampled import IS_WHOLE

SEEDS = 2 if IS_WHOLE else 1


@pytest.mark.parametrize("seed", range(SEEDS))
def test_plans_of_fleets_are_as_the_judge_says(seed: int) -> None:
    outcome = judge_many(70, seed)
    assert outcome.faults == []
    assert outcome.counts["enumerated"] > 40
    assert outcome.counts["searched"] > 1
