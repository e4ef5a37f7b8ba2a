"""The examples in docstrings are true."""

import doctest
from types import ModuleType

import pytest
from paretour import choice, questions

from service import instance, pareto, preferences
from service.coverage import frame


@pytest.mark.parametrize(
    "module",
    [choice, questions, instance, pareto, preferences, frame],
    ids=lambda m: m.__name__,
)
def test_the_examples_in_docstrings_are_true(module: ModuleType) -> None:
    results = doctest.testmod(module)
    assert results.attempted > 0
    assert results.failed == 0
