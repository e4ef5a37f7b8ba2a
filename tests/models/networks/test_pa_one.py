"""PA-One: that its tours are tours, and have the symmetries of the plane."""

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch import Generator, Tensor

from models.data.instances import uniform_cities, uniform_instances
from models.data.preferences import fan_of_preferences, fan_or_lattice
from models.networks.pa_one import OneActor
from tests.helpers.small_actors import CPU, small_actor


def steps_of(tours: Tensor) -> list[set[frozenset[int]]]:
    """The edges of each tour."""
    pairs = torch.stack((tours, tours.roll(1, dims=-1)), dim=-1).tolist()
    return [{frozenset(pair) for pair in tour} for tour in pairs]


@given(
    cities=st.lists(
        st.tuples(*4 * [st.sampled_from([0.0, 0.25, 0.3, 1.0])]), min_size=2, max_size=25
    )
)
def test_every_tour_visits_every_city_once_wherever_cities_are(
    cities: list[tuple[float, ...]],
) -> None:
    tours = small_actor("pa-one").tours(torch.tensor([cities]), fan_of_preferences(3, CPU))
    assert torch.equal(tours.sort(dim=-1).values, torch.arange(len(cities)).expand(1, 3, -1))


@pytest.mark.parametrize("name", ["pa-one", "pa-one-matrix"])
@pytest.mark.parametrize("objectives", [3, 4])
@pytest.mark.parametrize("n", [2, 3, 8, 40, 300])
def test_every_tour_visits_every_city_once_under_more_objectives(
    name: str, objectives: int, n: int
) -> None:
    drawn = uniform_instances(
        "matrices" if "matrix" in name else "coordinates",
        *(1, n, Generator().manual_seed(n), CPU, objectives),
    )
    preferences = fan_or_lattice(5, objectives, CPU)
    for tours in small_actor(name).repaired_tours(drawn, preferences, 2):
        expected = torch.arange(n).expand(1, len(preferences), -1)
        assert torch.equal(tours.sort(dim=-1).values, expected)


def test_tours_are_those_of_two_planes_where_the_others_are_the_second_again() -> None:
    actor = small_actor("pa-one").double()
    assert isinstance(actor, OneActor)
    two = uniform_cities(1, 60, Generator().manual_seed(1), CPU)[0].double()
    rows = torch.tensor([[0.3, 0.7], [0.5, 0.5], [0.9, 0.1]], dtype=torch.float64)
    expected = steps_of(actor.built(actor.problem(two, rows)))
    for shares in ([0.25, 0.75], [0.2, 0.5, 0.3]):
        cities = torch.cat([two[:, :2], *[two[:, 2:]] * len(shares)], dim=1)
        split = torch.cat([rows[:, :1], *(share * rows[:, 1:] for share in shares)], dim=1)
        assert steps_of(actor.built(actor.problem(cities, split))) == expected


def test_objectives_that_change_places_with_their_preferences_change_no_tour() -> None:
    actor = small_actor("pa-one").double()
    cities = uniform_cities(1, 40, Generator().manual_seed(2), CPU, 4).double()
    preferences = fan_or_lattice(9, 4, CPU).double()
    order = [2, 0, 3, 1]
    moved = cities.unflatten(-1, (4, 2))[:, :, order].flatten(2)
    found = actor.repaired_tours(moved, preferences[:, order], 3)[0][0]
    assert steps_of(found) == steps_of(actor.repaired_tours(cities, preferences, 3)[0][0])


@pytest.mark.parametrize("n", [2, 3, 8, 9, 100])
def test_every_tour_visits_every_city_once_however_many(n: int) -> None:
    instances = uniform_cities(3, n, Generator().manual_seed(n), CPU)
    tours = small_actor("pa-one").tours(instances, fan_of_preferences(7, CPU))
    assert torch.equal(tours.sort(dim=-1).values, torch.arange(n).expand(3, 7, -1))


def test_numbering_the_cities_otherwise_changes_no_tour() -> None:
    actor, preferences = small_actor("pa-one").double(), fan_of_preferences(5, CPU).double()
    instances = uniform_cities(1, 40, Generator().manual_seed(1), CPU).double()
    order = torch.randperm(40, generator=Generator().manual_seed(2))
    renumbered = actor.tours(instances[:, order], preferences)[0]
    assert steps_of(order[renumbered]) == steps_of(actor.tours(instances, preferences)[0])


def test_the_symmetries_of_the_plane_and_its_unit_change_no_tour() -> None:
    actor, preferences = small_actor("pa-one").double(), fan_of_preferences(5, CPU).double()
    instances = uniform_cities(1, 40, Generator().manual_seed(1), CPU).double()
    expected = steps_of(actor.tours(instances, preferences)[0])
    turned = instances.unflatten(-1, (2, 2)).flip(-1).flatten(2)
    for seen in (turned, 1 - instances, 64 * instances, instances + 5):
        assert steps_of(actor.tours(seen, preferences)[0]) == expected


def test_planes_that_change_places_mirror_the_tours() -> None:
    actor, preferences = small_actor("pa-one").double(), fan_of_preferences(5, CPU).double()
    instances = uniform_cities(1, 40, Generator().manual_seed(1), CPU).double()
    mirrored = actor.tours(instances.roll(2, dims=-1), preferences.flip(-1))[0]
    assert steps_of(mirrored) == steps_of(actor.tours(instances, preferences)[0])
