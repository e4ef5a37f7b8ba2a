"""Additive attention, the score v . tanh(x + y) of each city x for each row y, in one pass.

With tanh(x + y) = 1 - 2 / (1 + exp(2x) exp(2y)) the exponentials are taken once for a city and
once for a row. What is left for each pair is a sum of quotients, which PyTorch works out in
several passes over a (r, n, p) tensor, for visited cities too. On a CPU this takes most of the
time of training, so there it is compiled code that keeps nothing of that size, in either direction.
"""

import inspect
from collections.abc import Callable
from typing import Any, ParamSpec

import numpy as np
import torch
from jaxtyping import Bool, Float
from numba import njit
from numpy.typing import NDArray
from torch import Tensor
from torch.autograd.function import once_differentiable

P = ParamSpec("P")
Array = NDArray[np.float32]
Three = tuple[Array, Array, Array]  # of cities, of rows, of the judge

# Bound on 2x and 2y, so that the product of their exponentials is finite.
_MOST = 43.0


def exponential(projected: Float[Tensor, "*x p"]) -> Float[Tensor, "*x p"]:
    """Return exp(2x), the form in which `pointed` takes cities and rows."""
    return (2 * projected).clamp(-_MOST, _MOST).exp()


def pointed(
    cities: Float[Tensor, "b n p"],
    rows: Float[Tensor, "b r p"],
    judge: Float[Tensor, " p"],
    visited: Bool[Tensor, "b r n"],
) -> Float[Tensor, "b r n"]:
    """Return the scores of the cities for each row, with v the judge; undefined where visited."""
    if cities.device.type == "cpu" and not torch.compiler.is_exporting():
        quotients: Tensor = _Quotients.apply(  # type: ignore[no-untyped-call]  # torch's
            cities, rows, judge, visited
        )
    else:
        quotients = torch.reciprocal(1 + cities[:, None] * rows[:, :, None])
        # A matrix of one column: ONNX Runtime multiplies by a vector at half the speed.
        quotients = (quotients @ judge[:, None]).squeeze(-1)
    return judge.sum() - 2 * quotients


class _Quotients(torch.autograd.Function):
    """The sums of v / (1 + exp(2x) exp(2y)), zero where visited."""

    @staticmethod
    def forward(ctx: Any, *tensors: Tensor) -> Tensor:
        ctx.save_for_backward(*tensors)
        cities, rows, judge, visited = _as_arrays(tensors)
        sums = np.zeros(visited.shape, np.float32)
        _add_up(cities, rows, judge, visited, sums)
        return torch.from_numpy(sums)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, gradient: Tensor) -> tuple[Tensor | None, ...]:
        cities, rows, judge, visited = _as_arrays(ctx.saved_tensors)
        gradients = (np.zeros_like(cities), np.zeros_like(rows), np.zeros_like(judge))
        of_sums = gradient.masked_fill(torch.from_numpy(visited), 0.0).contiguous().numpy()
        _add_up_gradients((cities, rows, judge), of_sums, gradients)
        return *map(torch.from_numpy, gradients), None


def _as_arrays(tensors: tuple[Tensor, ...]) -> list[NDArray[Any]]:
    return [tensor.detach().contiguous().numpy() for tensor in tensors]


def _compiled(function: Callable[P, None]) -> Callable[P, None]:
    """Compile a function to code that may reorder sums; unwrapped of the checks that tests add."""
    kernel: Callable[P, None] = njit(fastmath=True, cache=True, nogil=True)(
        inspect.unwrap(function)
    )
    return kernel


@_compiled
def _add_up(
    cities: Array, rows: Array, judge: Array, visited: NDArray[np.bool_], sums: Array
) -> None:
    b, r, n = visited.shape
    for i in range(b):
        for j in range(r):
            row = rows[i, j]
            for city in range(n):
                if not visited[i, j, city]:
                    total = np.float32(0)
                    for p in range(len(judge)):
                        total += judge[p] / (np.float32(1) + cities[i, city, p] * row[p])
                    sums[i, j, city] = total


@_compiled
def _add_gradients(of_sum: np.float32, given: Three, gradients: Three, room: Array) -> None:
    """Add the gradients of one city and row.

    Short loops over few arrays become vector code, one long loop does not.
    """
    city, row, judge = given
    of_city, of_row, of_judge = gradients
    for p in range(len(room)):
        room[p] = np.float32(1) / (np.float32(1) + city[p] * row[p])
    for p in range(len(room)):
        of_judge[p] += of_sum * room[p]
    for p in range(len(room)):
        room[p] *= of_sum * judge[p] * room[p]
    for p in range(len(room)):
        of_city[p] -= room[p] * row[p]
    for p in range(len(room)):
        of_row[p] -= room[p] * city[p]


@_compiled
def _add_up_gradients(given: Three, of_sums: Array, gradients: Three) -> None:
    cities, rows, judge = given
    of_cities, of_rows, of_judge = gradients
    b, r, n = of_sums.shape
    room = np.empty(len(judge), np.float32)
    for i in range(b):
        for j in range(r):
            for city in range(n):
                if of_sums[i, j, city] != 0:
                    _add_gradients(
                        of_sums[i, j, city],
                        (cities[i, city], rows[i, j], judge),
                        (of_cities[i, city], of_rows[i, j], of_judge),
                        room,
                    )
