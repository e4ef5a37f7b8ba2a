"""Files of TSPLIB as they are published are planned to the lengths that are known for them."""

from pathlib import Path

import httpx
import pytest

from tests.helpers.sampled import few

FOLDER = Path(__file__).parent / "tsplib"
# As TSPLIB gives them. The first five have weights of one kind each, and the others of these.
OPTIMA = {
    "gr17": 2085,
    "bayg29": 1610,
    "bays29": 2020,
    "ulysses16": 6859,
    "att48": 10628,
    "gr21": 2707,
    "gr24": 1272,
    "fri26": 937,
    "ulysses22": 7013,
}


def test_every_file_has_an_optimum() -> None:
    assert {path.name for path in FOLDER.iterdir()} == {f"{name}.tsp" for name in OPTIMA}


@pytest.mark.parametrize(("name", "optimum"), few(5, OPTIMA.items()))
def test_the_plan_for_a_file_has_the_length_of_its_optimum(
    name: str, optimum: int, released: str
) -> None:
    """The file is both objectives, so that the front is one point."""
    file = (f"{name}.tsp", (FOLDER / f"{name}.tsp").read_bytes())
    read = httpx.post(f"{released}/files", files=[("file", file)] * 2).json()
    request = {**read["request"], "time_limit": 30}  # far more than it takes to converge
    answer = httpx.post(f"{released}/front", json=request, timeout=300).json()
    assert [item["lengths"] for item in answer["front"]] == [[optimum, optimum]]
    assert answer["terminated"] == "converged"
