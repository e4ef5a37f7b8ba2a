"""Hold what fronts of all kinds have in common: attributes, and how a notebook shows them."""

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import index as whole
from typing import Any, Generic, TypeVar

from paretour import display
from paretour.choice import losses
from paretour.described import Array, Lengths, answer, member, of_each
from paretour.questions import OPTIONS, QUESTIONS, Question, ask
from paretour.text_sets import label, text_set, unnamed

Item = TypeVar("Item")  # a tour, or a plan


@answer("ObjectiveName", eq=True, kw_only=False)
class Objective:
    """An objective of a front."""

    name: str = member("as in the request")
    unit: str | None = member(always=True)

    @property
    def label(self) -> str:
        """The name, with the unit if there is one."""
        return label(self.name, self.unit)


@answer("FleetObjectiveName", eq=True, kw_only=False)
class FleetObjective(Objective):
    """An objective of a fleet's front."""

    over: str = member("whether the routes of a plan are added, or the longest counts")
    measure: str | None = member("of plans, if it is not of costs", default=None)


@answer("RequestNote", eq=True, kw_only=False)
class RequestNote:
    """A note on a request that was planned: something in it is likely to be a mistake."""

    code: str = member("tells notes apart: place, swapped, far, outlier, large-costs or prizes")
    text: str = member("a sentence")
    pointer: str | None = member(
        "JSON pointer to the part of the request that it is about", default=None
    )


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class StoredFront(Generic[Item]):
    """A front of any kind, in order of the first length of its k tours or plans.

    `len(front)` is k, `front[i]` its i-th tour or plan, and `for` goes through all of them. The
    `lengths` of all are an array, shape (k, m). The `status` is queued, running, done, cancelled or
    failed. The `id` is empty if no service planned the front.
    """

    id: str
    status: str
    problem: Mapping[str, Any] | None = member("why it failed")
    kind: str | None = member("front, coverage, fleet or robots: what was planned")
    cities: int
    items: Sequence[Item] = member(named="front")
    points: int = member("nondominated points found; front holds at most `size`")
    hypervolume: float = member("of the front returned, 0 to 1")
    hypervolume_bound: float | None = member(
        "an upper bound for every front of this instance, if `bound` is true", always=True
    )
    reference_point: Lengths | None = member(
        "null, like the scale, until the costs are measured", always=True
    )
    scale: Lengths | None = member(always=True)
    actor: str | None = member("null where no network built tours, or none yet", always=True)
    timings_ms: Mapping[str, float] = member(
        "milliseconds of each phase of planning; once it has ended, first those in the queue, and"
        " last all since the request"
    )
    terminated: str | None = member(
        "how the search ended, null while it goes on. `converged`: up to eleven cities"
        " all tours were compared, and the front is exact; beyond, the search has long found"
        " nothing better in its neighbourhoods, which proves nothing. Where `time_limit` is 0 there"
        " was no search, and it says that all tours asked for were built",
        always=True,
    )
    closed: bool | None = member("false where tours are open routes, left out where closed")
    objectives: tuple[Objective, ...] | None = member("as the request names them")
    request_stops: tuple[Mapping[str, Any], ...] | None = member(
        "as the request has them", named="stops"
    )
    notes: tuple[RequestNote, ...] = member(
        "what is likely to be a mistake in the request, if anything is", default=()
    )
    lengths: Array = of_each("lengths")
    document: Mapping[str, Any] = member("the whole answer", named="")

    @property
    def losses(self) -> Array:
        """The lengths of each item in the front's own box, 0 at the least and 1 at the greatest."""
        return losses(self.lengths)

    @property
    def names(self) -> list[str]:
        """The name of each objective; `length_1` and so on, where the request named none."""
        if self.objectives:
            return [each.name for each in self.objectives]
        return unnamed(self.lengths.shape[1])

    @property
    def labels(self) -> list[str]:
        """The name of each objective, with its unit if there is one."""
        return [each.label for each in self.objectives] if self.objectives else self.names

    def __len__(self) -> int:
        return len(self.lengths)

    def __iter__(self) -> Iterator[Item]:
        return (self[number] for number in range(len(self)))

    def __getitem__(self, index: int) -> Item:
        """Return a tour or plan by its number, from 0; negative numbers count from the end.

        Raises:
            IndexError: The front does not have as many.
        """
        try:
            number = range(len(self))[whole(index)]
        except IndexError:
            raise IndexError(f"there are {self._counted()}, got {index}") from None
        return self.items[number]

    def ask(
        self, picks: Sequence[int] = (), *, questions: int = QUESTIONS, options: int = OPTIONS
    ) -> Question:
        """Return the question about the front that follows some picks.

        Its options are points, each as good as the one before or better in every objective. At the
        end its `chosen` is the number of a tour or plan.

        Args:
            picks: For each question so far, the index of the option that was picked.
            questions: How many questions there are, at most.
            options: How many options each has, at most.

        Raises:
            ValueError: A pick is not the index of an option, or the front is empty.
        """
        return ask(self.lengths, picks, questions=questions, options=options)

    @property
    def F(self) -> Array:  # noqa: N802
        """The lengths of each item, shape (k, m), by the name that pymoo has for them."""
        return self.lengths

    def to_moocore(self) -> str:
        """Return the lengths as a set of points in the text that moocore.read_datasets reads."""
        return text_set(self.labels, self.lengths)

    @abstractmethod
    def _counted(self) -> str:
        """Return how many tours or plans the front has."""

    @abstractmethod
    def _columns(self) -> Mapping[str, Sequence[Any]]:
        """Return a value for each tour or plan beside its lengths, by column."""

    def to_frame(self) -> Any:
        """Return a pandas DataFrame with a row for each tour or plan.

        It has a column for each objective, by name, and further ones for what else is known of
        tours or plans.

        Raises:
            ModuleNotFoundError: pandas is not installed.
        """
        from pandas import DataFrame

        lengths = dict(zip(self.names, self.lengths.T, strict=True))
        return DataFrame({**lengths, **self._columns(), **lengths})  # an objective's name prevails

    def plot(self, axes: Any = None) -> Any:
        """Draw the lengths under two or three objectives with matplotlib.

        Args:
            axes: The axes to draw into; for three objectives of the projection "3d". By default
                those of a new figure.

        Returns:
            The axes.

        Raises:
            ValueError: The front has four objectives.
            ModuleNotFoundError: matplotlib is not installed.
        """
        from paretour.plot import draw_lengths

        return draw_lengths(self.lengths, self.labels, axes)

    def __repr__(self) -> str:
        named = f"{type(self).__name__} {display.shown(self.id)}".rstrip()
        return f"<{named}: {self._summary()}>"

    def _summary(self) -> str:
        return display.summary(
            self._counted(),
            self.labels,
            self.lengths,
            f"hypervolume {self.hypervolume:.2%}",
            self.terminated or self.status,
        )

    def _repr_html_(self) -> str:
        """Return the front as HTML for a notebook: a sentence, a chart and a table."""
        numbers = {
            name: values
            for name, values in self._columns().items()
            if len(values) and isinstance(values[0], int | float)
        }
        return display.page(self._summary(), self.labels, self.lengths, numbers)
