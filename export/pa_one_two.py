"""Parts of PA-One's ONNX graph that are of two objectives alone: what rows share, and the turn."""

import torch
from torch import Tensor, nn

from export.onnx_parts import Part
from export.pa_one_names import Names
from export.repairs import as_costs, present
from models.data.preferences import turned_outwards
from models.networks.joining.costs import Matrices, Prices, Problem
from models.networks.joining.prices import prices_at_knots, prices_between
from models.networks.joining.shortlists import Shortlists, lists_of_rows, shortlists, shortlists_of
from models.networks.pa_one import OneActor


class _Turn(nn.Module):
    """The preferences, turned away from the diagonal."""

    def forward(self, preferences: Tensor) -> Tensor:
        return turned_outwards(preferences)


class _Know(nn.Module):
    """The prices of the cities at each knot."""

    def forward(self, *tables: Tensor) -> tuple[Tensor, ...]:
        return prices_at_knots(Matrices(*tables))


class _Price(nn.Module):
    """The prices of the cities in each row, from those at the knots."""

    def forward(self, rows: Tensor, fees: Tensor, tilts: Tensor) -> tuple[Tensor, ...]:
        return prices_between(rows, Prices(fees, tilts))


class _List(nn.Module):
    """The shortlists of some cities."""

    def __init__(self, actor: OneActor) -> None:
        super().__init__()
        self.knots = actor.list_sizes.knots

    def forward(
        self,
        tables: tuple[Tensor, ...],
        known: tuple[Tensor, ...],
        some: Tensor,
        listed: Tensor,
    ) -> tuple[Tensor, ...]:
        prices = Prices(*known) if known else None
        costs = as_costs(tables)
        return present(shortlists_of(some, costs, self.knots, listed.shape[0], prices))


class _ListRows(nn.Module):
    """The lists of the rows, from those of the intervals."""

    def forward(self, rows: Tensor, lists: tuple[Tensor, ...]) -> tuple[Tensor, ...]:
        return present(lists_of_rows(Shortlists(*lists), rows))


def parts(
    actor: OneActor,
    names: Names,
    given: tuple[Tensor, Problem],
    listed: tuple[Tensor, Tensor],
) -> dict[str, Part]:
    """Return the parts by name, to be traced with preferences and their problem.

    Listed are some cities to make lists of, and as many entries as a list has.
    """
    preferences, problem = given
    tables = tuple(problem.costs)
    with torch.no_grad():
        known = actor.known_prices(problem.costs)
        sizes = actor.list_sizes.knots, len(listed[1])
        lists = shortlists(problem.costs, *sizes, known)
    of_two: dict[str, Part] = {
        "Turn": (_Turn(), (preferences,), ["preferences"], ["turned_preferences"]),
        "List": (
            _List(actor),
            (tables, tuple(known or ()), *listed),
            [*names.tables, *names.known, "some_cities", "on_a_list"],
            list(names.lists),
        ),
        "ListRows": (
            _ListRows(),
            (problem.weights, present(lists)),
            ["weights", *names.lists],
            list(names.row_lists),
        ),
    }
    if known is None:
        return of_two
    return {
        **of_two,
        "Know": (_Know(), tables, list(names.tables), list(names.known)),
        "Price": (
            _Price(),
            (problem.weights, *known),
            ["weights", *names.known],
            list(names.prices),
        ),
    }
