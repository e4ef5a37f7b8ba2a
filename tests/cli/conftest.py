"""A service, and a file to plan."""

import json
from pathlib import Path

import numpy as np
import pytest


@pytest.fixture(scope="package")
def url(released: str) -> str:
    return released


@pytest.fixture
def cities(tmp_path: Path) -> Path:
    """A file of so few cities that a search of them converges."""
    path = tmp_path / "cities.json"
    path.write_text(json.dumps(np.random.default_rng(2).random((10, 4)).tolist()))
    return path
