"""Actors: networks in ONNX files, which build a tour for each preference."""

from functools import partial
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.actor_info import RELEASED, check_names, onnx_files, read_actor_info
from service.construction.call_estimate import CallEstimate
from service.errors import Cancelled
from service.instance import PLANE, Instance
from service.onnx_runtime import onnxruntime
from service.sessions import open_session

Array = NDArray[np.float64]
Tours = NDArray[np.int64]
Indices = NDArray[np.intp]
_FATAL = 4  # the least severity that ONNX Runtime writes to stderr
_FEW = 100  # a session keeps less than 20 MB after calls of this many cities or preferences
_MIN_PLACES = 3  # with fewer there is only one tour, and no network was trained on them
_RESOLUTION = 2.0**20  # of a plane: cities whose coordinates round to the same are at one place
_LARGEST_COST = 2.0  # scaled, of a forbidden leg or an outlier: networks were trained on up to 1
_MARGIN = 0.25  # around the unit square, in which cities far from all others are put
_LEAST_PREFERENCE = 1e-3  # for an objective: else all cities that coincide in the other are alike
_JITTER = 1e-6  # relative: inputs with ties are joined one pair after another, and take minutes
_SAMPLED = 32  # rows of matrices, in which ties are looked for


class OnnxActor:
    """The network of an ONNX file, which runs in a number of threads.

    The file's metadata are read at once. `load` or the first call opens its inference session: that
    takes up to a second, and a process often needs only a few of the actors.

    Raises:
        ValueError: The file is not ONNX, lacks metadata, or reads neither coordinates nor matrices.
    """

    def __init__(self, path: Path, threads: int) -> None:
        content = path.read_bytes()
        self.info = read_actor_info(content, path)
        self.estimate = CallEstimate(self.info.inputs)
        self._open = partial(open_session, content, path, threads)
        self._session: onnxruntime.InferenceSession | None = None
        self._loading = Lock()
        self._lock = Lock()
        self._running = onnxruntime.RunOptions()

    def load(self) -> None:
        """Open the inference session, unless it is open.

        Raises:
            ValueError: ONNX Runtime cannot run the file as a network.
        """
        with self._loading:
            if self._session is None:
                self._session = self._open()

    def tours(self, instance: Instance, preferences: Array, repairs: int = 0) -> Tours:
        """Return tours, shape (k, n), one for each preference, shape (k, m), by one inference.

        The network sees cities at one place as one city; in the tours they follow one another.
        With repairs, each tour is repaired that many times, and the shape is (2k, n): the k last
        rows are other tours, which the repairs found on the way.

        Raises:
            ValueError: Repairs are asked for, and the file has no input for them.
            RuntimeError: A tour is not a permutation, which is a fault of the file.
            Cancelled: `terminate` was called.
        """
        if repairs > 0 and not self.info.repairs:
            raise ValueError(f"{self.info.name} cannot repair tours, got repairs {repairs}")
        outputs = ["tours", "visited"] if repairs > 0 else ["tours"]
        options = _run_options(max(instance.n, len(preferences)) > _FEW)
        with self._lock:
            self._running = options
        if self.info.inputs == "matrices":
            scaled = instance.scaled_matrices.clip(max=_LARGEST_COST)
            matrices = _without_zeros(scaled.astype(np.float32))
            first, place = _places_by_matrices(matrices)
            costs = _without_tied_costs(matrices[:, first[:, np.newaxis], first])
            inputs: dict[str, NDArray[Any]] = {"matrices": costs}
        else:
            scaled = instance.scaled_coordinates.clip(-_MARGIN, 1 + _MARGIN)
            planes = scaled.astype(np.float32).reshape(instance.n, -1, PLANE)
            cities = _without_zeros(planes.swapaxes(0, 1)).swapaxes(0, 1).reshape(scaled.shape)
            first, place = _places(np.rint(cities * np.float32(_RESOLUTION)))
            inputs = {"cities": _without_tied_cities(cities[first])}
        if len(first) < _MIN_PLACES:
            return np.tile(np.argsort(place, kind="stable"), (len(outputs) * len(preferences), 1))
        inputs["preferences"] = preferences.clip(_LEAST_PREFERENCE).astype(np.float32)
        if self.info.repairs:
            inputs["repairs"] = np.array(repairs, dtype=np.int64)
        tours = self._run(inputs, outputs, options)
        if not (np.sort(tours, axis=1) == np.arange(len(first))).all():
            raise RuntimeError(f"{self.info.name} built a tour that is not a permutation")
        if len(first) == instance.n:
            return tours
        return np.argsort(np.argsort(tours, axis=1)[:, place], axis=1, kind="stable")

    def terminate(self) -> None:
        """End the running call of `tours`, if there is one, within some milliseconds.

        May be called in any thread, repeatedly. A call that begins later is not affected.
        """
        with self._lock:
            self._running.terminate = True

    def _run(
        self,
        inputs: dict[str, NDArray[Any]],
        outputs: list[str],
        options: onnxruntime.RunOptions,
    ) -> Tours:
        self.load()
        assert self._session is not None
        try:
            tours: Tours = np.concatenate(self._session.run(outputs, inputs, options))
        except Exception:
            if options.terminate:
                raise Cancelled from None
            raise
        return tours


def load_actors(
    directory: Path, threads: int, own_directory: Path | None = None
) -> dict[str, OnnxActor]:
    """Return the actors of the ONNX files in a directory, and in one of the user's, by name.

    Each runs in a number of threads. The user's files are opened at once, so that the service does
    not start with a file that ONNX Runtime cannot run.

    Raises:
        ValueError: As in read_actor_infos; or ONNX Runtime cannot run one of the user's files.
    """
    actors = {path: OnnxActor(path, threads) for path in onnx_files(directory, own_directory)}
    check_names({path: actor.info for path, actor in actors.items()})
    for path, actor in actors.items():
        if path.parent != RELEASED:
            actor.load()
    return {actor.info.name: actor for actor in actors.values()}


def _places(rows: NDArray[np.floating[Any]]) -> tuple[Indices, Indices]:
    """Return the first of each group of equal rows, and the group of each row.

    Equal rows are cities at one place.
    """
    numbers: dict[bytes, int] = {}
    place = np.array([numbers.setdefault(row.tobytes(), len(numbers)) for row in rows])
    if len(numbers) == len(rows):
        return place, place
    return np.unique(place, return_index=True)[1], place


def _places_by_matrices(matrices: NDArray[np.float32]) -> tuple[Indices, Indices]:
    """Return the same for matrices, shape (m, n, n): cities at one place have equal costs."""
    n = matrices.shape[1]
    if np.count_nonzero((matrices == 0).all(axis=0)) <= n:  # only the diagonal: all are apart
        return np.arange(n), np.arange(n)
    return _places(np.concatenate((*matrices, *matrices.transpose(0, 2, 1)), axis=1) + 0.0)


def _without_zeros(objectives: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return planes or matrices, shape (m, n, ...), with another one in place of each of zeros.

    All tours have the same length in an objective of zeros, so only the others matter.
    """
    known = np.flatnonzero(objectives.reshape(len(objectives), -1).any(axis=1))
    if len(known) in (0, len(objectives)):
        return objectives
    chosen = np.arange(len(objectives))
    chosen[np.setdiff1d(chosen, known)] = known[0]
    return objectives[chosen]


def _without_tied_cities(cities: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return cities, shape (n, 2 m), moved a little where most coincide with others in a plane."""
    planes = cities.reshape(len(cities), -1, PLANE).swapaxes(0, 1)
    if all(2 * len(np.unique(plane, axis=0)) > len(cities) for plane in planes):
        return cities
    moves = np.random.default_rng(0).random(cities.shape, np.float32)
    return cities + np.float32(_JITTER) * moves


def _without_tied_costs(matrices: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return matrices, shape (m, n, n), changed a little where most costs of a row are equal."""
    n = matrices.shape[1]
    rows = matrices[:, :: -(-n // _SAMPLED)]
    if all(len(np.unique(costs)) > n for costs in rows):
        return matrices
    factors = np.random.default_rng(0).random(matrices.shape, np.float32)
    return matrices * (1 + np.float32(_JITTER) * factors)


def _run_options(many: bool) -> onnxruntime.RunOptions:
    """Return the options of a call; `many` is whether it has many cities or preferences."""
    options = onnxruntime.RunOptions()
    options.log_severity_level = _FATAL  # being terminated is not an error
    if many:
        # Otherwise memory that the largest instance needed is never freed (onnxruntime#11627).
        # Freeing and allocating a little again takes 2 % of a call at 40 cities.
        options.add_run_config_entry("memory.enable_memory_arena_shrinkage", "cpu:0")
    return options
