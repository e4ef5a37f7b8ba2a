"""A service, and a file to plan."""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from tests.helpers.serving import serving_released


@pytest.fixture(scope="package")
def url() -> Iterator[str]:
    with serving_released() as address:
        yield address


@pytest.fixture
def cities(tmp_path: Path) -> Path:
    """A file of so few cities that a search of them converges."""
    path = tmp_path / "cities.json"
    path.write_text(json.dumps(np.random.default_rng(2).random((10, 4)).tolist()))
    return path
