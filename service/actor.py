"""Networks as they are shipped: one ONNX file each, an instance and preferences in, tours out."""

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

import numpy as np
import onnxruntime
from numpy.typing import NDArray

from service.instance import Instance, Kind

Array = NDArray[np.float64]
Tours = NDArray[np.int64]
_METADATA = ("name", "config", "commit", "sizes", "angles", "figures", "inputs")
_FEW = 100  # cities, and preferences, for which a session keeps less than 20 MB


@dataclass(frozen=True, kw_only=True)
class ActorFacts:
    """Who an actor is: what its file says of itself, and the SHA-256 of that file, in hex.

    `sizes` and `angles` are what it was trained on, `figures` what was measured of it, `inputs`
    the kind of instance that it reads: `coordinates` (a row of four for each city, each plane
    moved and scaled into the unit square) or `matrices` (2, n, n) (in units of the scale, with
    zeros on the diagonal).
    """

    name: str
    digest: str
    commit: str
    inputs: Kind
    sizes: Any
    angles: Any
    config: Any
    figures: Any

    @property
    def named(self) -> dict[str, str]:
        """Which it is, as an answer says it."""
        return {"name": self.name, "digest": self.digest}

    def serves(self, kind: Kind) -> bool:
        """Whether it can build tours for instances of this kind: coordinates have distances."""
        return self.inputs in ("matrices", kind)


class Actor:
    """An ONNX file that builds a tour for every preference in one inference call.

    Raises:
        ValueError: the file lacks metadata, or reads something else.
    """

    def __init__(self, path: Path, threads: int) -> None:
        content = path.read_bytes()
        self._session = onnxruntime.InferenceSession(
            content, _options(threads), providers=["CPUExecutionProvider"]
        )
        self._giving_back = onnxruntime.RunOptions()
        # Else what the largest instance needed is never given back (microsoft/onnxruntime#11627).
        shrink = ("memory.enable_memory_arena_shrinkage", "cpu:0")
        self._giving_back.add_run_config_entry(*shrink)
        metadata = self._session.get_modelmeta().custom_metadata_map
        if missing := [name for name in _METADATA if name not in metadata]:
            raise ValueError(f"the metadata of {path} must have {', '.join(missing)}")
        self.facts = ActorFacts(
            digest=hashlib.sha256(content).hexdigest(),
            inputs=_kind(metadata["inputs"], path),
            **{name: metadata[name] for name in ("name", "commit")},
            **{name: _decoded(metadata[name]) for name in ("sizes", "angles", "config", "figures")},
        )

    def tours(self, instance: Instance, preferences: Array) -> Tours:
        """One tour, a row of shape (n,), for each preference, a row of shape (k, 2)."""
        inputs = {**self._read(instance), "preferences": preferences.astype(np.float32)}
        # To give a little back and to get it again takes 2 % of a call at 40 cities.
        few = max(instance.n, len(preferences)) <= _FEW
        (tours,) = self._session.run(["tours"], inputs, None if few else self._giving_back)
        if not (np.sort(tours, axis=1) == np.arange(instance.n)).all():
            raise RuntimeError(f"{self.facts.name} built a tour that is not a permutation")
        return tours

    def _read(self, instance: Instance) -> dict[str, NDArray[np.float32]]:
        if self.facts.inputs == "matrices":
            return {"matrices": instance.scaled_matrices.astype(np.float32)}
        return {"cities": instance.scaled_coordinates.astype(np.float32)}


def load_actors(directory: Path, threads: int) -> dict[str, Actor]:
    """The actors in a directory, by name.

    Raises:
        ValueError: there is none, or two have the same name.
    """
    actors = [Actor(path, threads) for path in sorted(directory.glob("*.onnx"))]
    by_name = {actor.facts.name: actor for actor in actors}
    if not actors or len(by_name) < len(actors):
        names = [actor.facts.name for actor in actors]
        raise ValueError(f"{directory} must hold ONNX files of different names, got {names}")
    return by_name


def _kind(given: str, path: Path) -> Kind:
    for kind in get_args(Kind):
        if given == kind:
            return kind
    raise ValueError(f"inputs of {path} must be coordinates or matrices, got {given!r}")


def _options(threads: int) -> onnxruntime.SessionOptions:
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    options.inter_op_num_threads = 1
    # Threads that spin while they wait take the cores from the plans beside them.
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    return options


def _decoded(text: str) -> Any:
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        return text
