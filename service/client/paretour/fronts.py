"""Hold what fronts of all kinds have in common: attributes, and how a notebook shows them."""

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import index as whole
from typing import Any, Generic, TypeVar

from paretour import display
from paretour.choice import losses
from paretour.described import Array, answer, member
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

    `len(front)` is k, `front[i]` its i-th tour or plan, and `for` goes through all of them.

    Attributes:
        id: The id under which the service stores the front; empty if no service planned it.
        status: The status of its job: queued, running, done, cancelled or failed.
        lengths: The lengths of each tour or plan, shape (k, m).
        points: The number of nondominated ones found; the front is a subset of these.
        hypervolume: The share of the box at the reference point that these k dominate.
        reference_point: The reference point of the hypervolume, shape (m,); None while it is not
            known.
        terminated: Why the search ended: `converged`, `time_limit` or `cancelled`, or a word of a
            later service; None while it runs. `converged` proves that nothing is better only up to
            eleven cities.
        document: The whole answer, with every member.
        objectives: The objectives, if the request named them.
        notes: What is likely to be a mistake in the request.
    """

    id: str
    status: str
    lengths: Array
    points: int
    hypervolume: float
    reference_point: Array | None
    terminated: str | None
    document: Mapping[str, Any]
    objectives: tuple[Objective, ...] | None = None
    notes: tuple[RequestNote, ...] = ()

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
        return self._item(number)

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
    def _item(self, number: int) -> Item:
        """Return a tour or plan by its number, which is one of the front's."""

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
