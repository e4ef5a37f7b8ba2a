"""Write points as text that moocore reads: its `read_datasets`, in Python and in R."""

from collections.abc import Iterable, Sequence


def label(name: str, unit: str | None) -> str:
    """Return the name of an objective, with the unit if there is one."""
    return name if unit is None else f"{name} ({unit})"


def unnamed(count: int) -> list[str]:
    """Return what objectives are called whose request named none."""
    return [f"length_{number + 1}" for number in range(count)]


def text_set(names: Iterable[str], points: Iterable[Sequence[float]]) -> str:
    """Return a line for each point, after a comment that names the objectives.

    An empty line ends the set, so that the texts of several fronts may follow each other.

    Args:
        names: Those of the objectives.
        points: The lengths of each tour or plan, exact to the last digit.
    """
    heading = ", ".join(" ".join(name.split()) for name in names)
    lines = [" ".join(repr(float(length)) for length in point) for point in points]
    return "\n".join([f"# {heading}", *lines, "", ""])
