"""The objectives that training minimises: the Lagrangian and the weighted sum.

Mehta, Taghipour and Saeedi (2022), arXiv:2203.01298, equations 10 to 18: make the norm of a
tour's lengths small, while the vector of lengths points along the preference. The weighted
sum is the usual alternative, of the linear scalarisation that the paper compares with.
"""

from jaxtyping import Float
from torch import Tensor

from models.data.preferences import weights


def violation(
    points: Float[Tensor, "b k m"], preferences: Float[Tensor, "k m"]
) -> Float[Tensor, "b k"]:
    """Return one minus the cosine of the angle between each point and its preference."""
    return 1 - (points * preferences).sum(-1) / points.norm(dim=-1)


def lagrangian(
    points: Float[Tensor, "b k m"],
    preferences: Float[Tensor, "k m"],
    multipliers: Float[Tensor, " k"],
) -> Float[Tensor, "b k"]:
    """Return the norm of each point plus its preference's multiplier times its violation."""
    return points.norm(dim=-1) + multipliers * violation(points, preferences)


def ascended(
    multipliers: Float[Tensor, " k"],
    violations: Float[Tensor, "b k"],
    ascent_rate: float,
    limits: tuple[float, float],
) -> Float[Tensor, " k"]:
    """Return the multipliers after one step up along the mean violation, clipped to the limits."""
    least, most = limits
    return (multipliers + ascent_rate * violations.mean(dim=0)).clamp(least, most)


def weighted_sum(
    points: Float[Tensor, "b k m"], preferences: Float[Tensor, "k m"]
) -> Float[Tensor, "b k"]:
    """Return the sum of each point's lengths under the weights that go with its preference."""
    return (points * weights(preferences)).sum(-1)
