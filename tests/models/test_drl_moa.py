"""DRL-MOA: its network, the transfer of weights, and what a user of its command sees."""

import csv
from itertools import permutations
from pathlib import Path

import pytest
import torch
from torch import Generator, Tensor

from models import drl_moa
from models.data.sampling import uniform_cities
from models.drl_moa import TransferConfig, finish, load_actors, new_run, resume, save, take_step
from models.networks.pointer_network import PointerActor, build_tours, log_likelihoods
from models.rollout import sampling

SMALL = TransferConfig(
    subproblems=3, first_steps=4, steps=2, instances=8, cities=6, width=16, save_every=1
)


def cities(count: int, n: int) -> Tensor:
    return uniform_cities(count, n, Generator().manual_seed(0), torch.device("cpu"))


def actor() -> PointerActor:
    actor = PointerActor(width=16)
    for parameter in actor.parameters():
        torch.nn.init.normal_(parameter, std=0.3, generator=Generator().manual_seed(5))
    return actor


def test_sampled_tours_visit_every_city_once() -> None:
    tours = build_tours(actor(), cities(5, 9), sampling(Generator().manual_seed(1)))
    assert (tours.sort(dim=-1).values == torch.arange(9)).all()


def test_the_likelihoods_of_all_tours_add_to_one() -> None:
    tours = torch.tensor(list(permutations(range(5))))
    likelihoods = log_likelihoods(actor(), cities(1, 5).expand(120, -1, -1), tours).exp()
    assert torch.isclose(likelihoods.sum(), torch.tensor(1.0), atol=1e-5)


def test_sampling_draws_tours_as_often_as_their_likelihood_says() -> None:
    many = 4000
    instances = cities(1, 4).expand(many, -1, -1)
    tours = build_tours(actor(), instances, sampling(Generator().manual_seed(2)))
    for tour in tours.unique(dim=0):
        share = (tours == tour).all(dim=1).double().mean()
        likelihood = log_likelihoods(actor(), instances[:1], tour[None]).exp().item()
        deviation = (likelihood * (1 - likelihood) / many) ** 0.5
        assert abs(share - likelihood) < 5 * deviation + 1e-6


def test_the_pointer_is_the_one_of_its_paper() -> None:
    """Against v tanh(W [e; h]) and v tanh(W [e; c]), written out for one moment."""
    network, instances = actor(), cities(1, 6)
    state = torch.randn(1, 1, 16, generator=Generator().manual_seed(3))
    visited = torch.tensor([[[False, True, False, False, True, False]]])
    features = network.embed_city(instances)[0]
    attended, reference = network.project_city(features).chunk(2, dim=-1)
    attention = torch.tanh(attended + network.project_state(state[0])) @ network.judges[0]
    context = attention.softmax(dim=0) @ features
    expected = torch.tanh(reference + network.project_context(context)) @ network.judges[1]
    found = network.logits(network.remember(instances), state, visited)
    assert torch.allclose(found[~visited], expected[~visited[0, 0]], atol=1e-5)
    assert (found[visited] == -torch.inf).all()


def test_a_network_begins_with_the_weights_of_the_one_before() -> None:
    run = new_run(SMALL)
    assert run.weights.tolist() == [1.0, 0.0]
    for _ in range(4):
        take_step(run)
    finish(run)
    assert run.weights.tolist() == [0.5, 0.5]
    assert run.steps == 2
    before = run.finished[0]
    assert all(torch.equal(x, before[name]) for name, x in run.actor.state_dict().items())
    take_step(run)
    assert not torch.equal(run.actor.judges, before["judges"])


def test_training_lowers_the_weighted_sum() -> None:
    config = TransferConfig(instances=64, cities=8, width=32, learning_rate=3e-3)
    run = new_run(config)
    objectives = [take_step(run) for _ in range(200)]
    assert sum(objectives[-20:]) < 0.93 * sum(objectives[:20])


def test_resuming_equals_not_having_stopped(tmp_path: Path) -> None:
    """Stopped within the second network, by the same command as it was begun with."""
    straight, stopped = new_run(SMALL), new_run(SMALL)
    drl_moa.train(straight, tmp_path / "straight")
    for _ in range(4):
        take_step(stopped)
    finish(stopped)
    take_step(stopped)
    (tmp_path / "stopped").mkdir()
    save(stopped, tmp_path / "stopped/run.pt")
    drl_moa.main(["--out", str(tmp_path / "stopped")])
    runs = (load_actors(tmp_path / name / "weights.pt") for name in ("straight", "stopped"))
    for theirs, ours in zip(*runs, strict=True):
        found = ours.state_dict()
        assert all(torch.equal(x, found[name]) for name, x in theirs.state_dict().items())
    assert len(resume(tmp_path / "stopped/run.pt").finished) == 3


def test_a_run_leaves_a_line_for_each_network(tmp_path: Path) -> None:
    drl_moa.train(new_run(SMALL), tmp_path)
    with (tmp_path / "log.csv").open() as file:
        lines = list(csv.DictReader(file))
    assert [(line["weight_1"], line["steps"]) for line in lines] == [
        ("1.0000", "4"),
        ("0.5000", "2"),
        ("0.0000", "2"),
    ]


@pytest.mark.parametrize("changes", [{"subproblems": 1}, {"steps": 0}, {"cities": 0}])
def test_a_configuration_that_makes_no_sense_is_refused(changes: dict[str, int]) -> None:
    with pytest.raises(ValueError, match="must be at least"):
        TransferConfig(**changes)
