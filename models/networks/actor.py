"""The interface of all actors: what training, validation, checkpoints and export use of them."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Literal

import torch
from jaxtyping import Bool, Float, Int
from torch import Generator, Tensor, nn

from models.data.instances import distinct_starts
from models.data.preferences import Groups, grouped
from models.networks.layers import SilenceableLayer
from models.networks.rows import repeated
from models.networks.stepwise import Conditioning, Decoder, Memory
from models.options import setting
from models.rollout import (
    greedily,
    log_likelihoods,
    log_likelihoods_by_city,
    roll_out,
    sampling,
    starts_in_turn,
)

# Logits this close are a tie: float32 sums of two orders differ by less, and either city may win.
_TIE = 1e-3


@dataclass(frozen=True, kw_only=True)
class Architecture:
    """Name and sizes of an actor; `models.config.NetworkConfig` also checks them."""

    name: str
    width: int = setting(128, "features of a city")
    heads: int = setting(8, "attention heads")
    layers: int = setting(5, "encoder layers")
    feedforward: int = setting(512, "hidden features of an encoder layer")
    clip: float = setting(10.0, "bound on the pointer's logits before distances are taken off")
    graph_layers: int = setting(3, "of PA-AD's graph encoder; 0 leaves out all but its features")
    preference_layers: int = setting(1, "0 leaves the preference out, as in the paper's ablation")


class Actor(nn.Module, ABC):
    """A network that builds tours of instances, one for each preference.

    Instances of m objectives are cities (b, n, 2m) where it reads coordinates, costs (b, m, n, n)
    where it reads matrices. Stepwise actors know two objectives.
    """

    reads: ClassVar[Literal["coordinates", "matrices"]]
    # City by city, or by joining fragments of tours; export works differently for each.
    construction: ClassVar[Literal["stepwise", "fragments"]]
    precisions: ClassVar[tuple[str, ...]] = ("float32", "bfloat16")  # of products in training
    # Whether imitation differs by the city at which a tour starts.
    imitates_starts: ClassVar[bool] = True
    repairs_tours: ClassVar[bool] = False
    most_objectives: ClassVar[int] = 2  # of an instance; two at least

    @property
    @abstractmethod
    def encoder_layers(self) -> nn.ModuleList:
        """The stack of layers whose depth is a setting."""

    @abstractmethod
    def tours(self, instances: Tensor, preferences: Float[Tensor, "k m"]) -> Int[Tensor, "b k n"]:
        """Return the greedy tour of each instance for each preference."""

    def repaired_tours(
        self, instances: Tensor, preferences: Float[Tensor, "k 2"], repairs: int
    ) -> tuple[Int[Tensor, "b k n"], Int[Tensor, "b k n"]]:
        """Return the greedy tours after the repairs, and for each another that they visited.

        Raises:
            ValueError: repairs are asked for, and the actor makes none.
        """
        if repairs > 0:
            raise ValueError(f"{type(self).__name__} cannot repair tours, got repairs {repairs}")
        tours = self.tours(instances, preferences)
        return tours, tours

    @abstractmethod
    def are_ties(
        self,
        instance: Tensor,
        preferences: Float[Tensor, "k 2"],
        repairs: int,
        both: tuple[Int[Tensor, "k n"], Int[Tensor, "k n"]],
    ) -> Bool[Tensor, " k"]:
        """Return which tours may differ by rounding alone; tours that are equal may.

        Args:
            instance: one, as the actor reads it, shape (1, ...).
            preferences: unit vectors.
            repairs: of the tours.
            both: tours for each preference as another program built them, and as this one did.
        """

    @abstractmethod
    def sampled_tours_with_log_likelihoods(
        self,
        instances: Tensor,
        preferences: Float[Tensor, "k 2"],
        times: int,
        start_generator: Generator,
        generator: Generator,
    ) -> tuple[Int[Tensor, "b kt n"], Float[Tensor, "b kt"]]:
        """Draw tours as often for each preference in turn, and return their log-likelihoods.

        Args:
            instances: as the actor reads them.
            preferences: unit vectors.
            times: tours drawn for each instance and preference.
            start_generator: draws the first cities, where these are given to the actor.
            generator: draws all else.
        """

    @abstractmethod
    def imitation_loss(
        self, instances: Tensor, preferences: Float[Tensor, "k 2"], tours: Int[Tensor, "b kt n"]
    ) -> Float[Tensor, ""]:
        """Return what the choices that an expert's tours ask for cost in likelihood.

        There are as many tours for each preference as the caller likes, one after the other; one
        where `imitates_starts` is false.
        """

    def silence_layers(self, depth: int) -> None:
        """Make the layers from that depth on give back what they get, until they are trained.

        Raises:
            ValueError: its layers cannot.
        """
        for layer in self.encoder_layers[depth:]:
            if not isinstance(layer, SilenceableLayer):
                raise ValueError(f"{type(self).__name__} must begin from weights of as many layers")
            layer.silence()


class StepwiseActor(Actor):
    """An actor that builds tours city by city: an encoder of instances, then a decoder."""

    construction = "stepwise"
    groups: ClassVar[int] = 1  # of preferences; it encodes an instance once for each group
    encoder: nn.Module
    decoder: Decoder

    @property
    def encoder_layers(self) -> nn.ModuleList:
        """The layers of the encoder."""
        layers = self.encoder.layers
        assert isinstance(layers, nn.ModuleList)
        return layers

    def grouped(self, preferences: Float[Tensor, "k 2"]) -> Groups:
        """Lay the preferences out as rows, in groups of neighbours."""
        return grouped(preferences, self.groups)

    @abstractmethod
    def remember(self, instances: Tensor, preferences: Float[Tensor, "r 2"]) -> Memory:
        """Compute what decoding needs of the instances, once for each group of preferences.

        The preferences come as `grouped` lays them out.
        """

    @torch.no_grad()
    def tours(self, instances: Tensor, preferences: Float[Tensor, "k 2"]) -> Int[Tensor, "b k n"]:
        """Return the greedy tour of each instance for each preference."""
        rows, _, places = self.grouped(preferences)
        starts = starts_in_turn(rows, instances).repeat(len(instances), 1)
        memory = self.remember(instances, rows)
        conditioning = self.decoder.condition(rows)
        return roll_out(self.decoder, memory, conditioning, starts, greedily)[:, places]

    @torch.no_grad()
    def are_ties(
        self,
        instance: Tensor,
        preferences: Float[Tensor, "k 2"],
        repairs: int,  # noqa: ARG002, there are none
        both: tuple[Int[Tensor, "k n"], Int[Tensor, "k n"]],
    ) -> Bool[Tensor, " k"]:
        """Return for which tours both cities are about as likely where the two part."""
        rows, members, places = self.grouped(preferences)
        memory, conditioning = self.remember(instance, rows), self.decoder.condition(rows)
        one, other = (
            log_likelihoods_by_city(self.decoder, memory, conditioning, tours[None, members])[
                0, places
            ]
            for tours in both
        )
        differs = both[0] != both[1]
        partings = differs.int().argmax(dim=1, keepdim=True)
        # Tours from a given city have one choice fewer than cities.
        choices = partings - (differs.shape[1] - one.shape[1])
        gaps = (one - other).gather(1, choices.clamp(min=0))[:, 0].abs()
        return (gaps <= _TIE) & (choices[:, 0] >= 0) | ~differs.any(dim=1)

    def sampled_tours_with_log_likelihoods(
        self,
        instances: Tensor,
        preferences: Float[Tensor, "k 2"],
        times: int,
        start_generator: Generator,
        generator: Generator,
    ) -> tuple[Int[Tensor, "b kt n"], Float[Tensor, "b kt"]]:
        """Draw tours as often for each preference in turn, and return their log-likelihoods.

        Each instance has the same starts for all its preferences.
        """
        b, n = len(instances), instances.shape[-2]
        drawn = distinct_starts(b, n, times, start_generator, instances.device)
        starts = drawn.repeat(1, len(preferences))
        memory, rows = self._encoded(instances, preferences, times)
        choose = sampling(generator)
        tours = roll_out(self.decoder, _detached(memory), rows, starts, choose)
        return tours, log_likelihoods(self.decoder, memory, rows, tours)

    def imitation_loss(
        self, instances: Tensor, preferences: Float[Tensor, "k 2"], tours: Int[Tensor, "b kt n"]
    ) -> Float[Tensor, ""]:
        """Return minus the mean log-likelihood of the cities that the actor has to choose."""
        times = tours.shape[1] // len(preferences)
        memory, rows = self._encoded(instances, preferences, times)
        return -log_likelihoods_by_city(self.decoder, memory, rows, tours).mean()

    def _encoded(
        self, instances: Tensor, preferences: Tensor, times: int
    ) -> tuple[Memory, Conditioning]:
        memory = self.remember(instances, preferences)
        return memory, repeated(self.decoder.condition(preferences), times)


def _detached(memory: Memory) -> Memory:
    return type(memory)(*(table.detach() for table in memory))
