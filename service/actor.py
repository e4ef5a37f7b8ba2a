"""Actors: the networks as released, one ONNX file each, which build a tour for each preference."""

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
_FEW = 100  # cities or preferences, up to which a session keeps less than 20 MB


@dataclass(frozen=True, kw_only=True)
class ActorInfo:
    """The metadata of an actor's ONNX file.

    Args:
        name: As requests name it.
        digest: SHA-256 of the file, in hex.
        commit: Of the code that wrote the file.
        inputs: The kind of instance that it reads: `coordinates`, shape (n, 4), each plane moved
            and scaled into the unit square; or `matrices`, shape (2, n, n), in units of the
            scale, with zeros on the diagonal.
        sizes: Least and greatest number of cities that it was trained on.
        angles: Least and greatest angle that it was trained on, in degrees.
        config: Of the training run.
        figures: Hypervolumes measured after training, by number of cities.
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
    def identity(self) -> dict[str, str]:
        """The name and digest, as answers report them."""
        return {"name": self.name, "digest": self.digest}

    def serves(self, kind: Kind) -> bool:
        """Return whether it builds tours for instances of a kind: matrices serve both kinds."""
        return self.inputs in ("matrices", kind)


class OnnxActor:
    """An ONNX file in an inference session of so many threads.

    Raises:
        ValueError: The file lacks metadata, or reads neither coordinates nor matrices.
    """

    def __init__(self, path: Path, threads: int) -> None:
        content = path.read_bytes()
        self._session = onnxruntime.InferenceSession(
            content, _options(threads), providers=["CPUExecutionProvider"]
        )
        self._shrinking = onnxruntime.RunOptions()
        # Else memory that the largest instance needed is never freed (microsoft/onnxruntime#11627).
        shrink = ("memory.enable_memory_arena_shrinkage", "cpu:0")
        self._shrinking.add_run_config_entry(*shrink)
        metadata = self._session.get_modelmeta().custom_metadata_map
        if missing := [name for name in _METADATA if name not in metadata]:
            raise ValueError(f"the metadata of {path} must have {', '.join(missing)}")
        self.info = ActorInfo(
            digest=hashlib.sha256(content).hexdigest(),
            inputs=_kind(metadata["inputs"], path),
            **{name: metadata[name] for name in ("name", "commit")},
            **{name: _decoded(metadata[name]) for name in ("sizes", "angles", "config", "figures")},
        )

    def tours(self, instance: Instance, preferences: Array) -> Tours:
        """Return tours, shape (k, n), one for each preference, shape (k, 2), by one inference.

        Raises:
            RuntimeError: A tour is not a permutation, which is a fault of the file.
        """
        inputs = {**self._inputs(instance), "preferences": preferences.astype(np.float32)}
        # To free a little memory and to allocate it again takes 2 % of a call at 40 cities.
        few = max(instance.n, len(preferences)) <= _FEW
        (tours,) = self._session.run(["tours"], inputs, None if few else self._shrinking)
        if not (np.sort(tours, axis=1) == np.arange(instance.n)).all():
            raise RuntimeError(f"{self.info.name} built a tour that is not a permutation")
        return tours

    def _inputs(self, instance: Instance) -> dict[str, NDArray[np.float32]]:
        if self.info.inputs == "matrices":
            return {"matrices": instance.scaled_matrices.astype(np.float32)}
        return {"cities": instance.scaled_coordinates.astype(np.float32)}


def load_actors(
    directory: Path, threads: int, own_directory: Path | None = None
) -> dict[str, OnnxActor]:
    """Return the actors of the ONNX files in a directory, and in one of the user's, by name.

    Each has an inference session of so many threads.

    Raises:
        ValueError: There is no file in a directory, or two actors have the same name.
    """
    actors: dict[str, OnnxActor] = {}
    files: dict[str, Path] = {}
    for path in [*_onnx_files(directory), *(_onnx_files(own_directory) if own_directory else ())]:
        actor = OnnxActor(path, threads)
        name = actor.info.name
        if name in actors:
            both = f"{files[name]} and {path}"
            raise ValueError(
                f"ONNX files must hold actors of different names, got {name} in {both}"
            )
        actors[name], files[name] = actor, path
    return actors


def _onnx_files(directory: Path) -> list[Path]:
    """Return the ONNX files of a directory; raise ValueError where there is none."""
    found = sorted(directory.glob("*.onnx"))
    if not found:
        raise ValueError(f"{directory} must hold ONNX files, got none")
    return found


def _kind(inputs: str, path: Path) -> Kind:
    for kind in get_args(Kind):
        if inputs == kind:
            return kind
    raise ValueError(f"inputs of {path} must be coordinates or matrices, got {inputs!r}")


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
