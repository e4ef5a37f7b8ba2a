"""Draw a front with matplotlib, which the extra `plot` installs."""

from pathlib import Path

from matplotlib.backend_bases import FigureCanvasBase
from matplotlib.figure import Figure
from paretour import FrontOfAnyKind

from service.cli.errors import UsageError
from service.cli.labels import labels_of


def check_path(path: Path) -> None:
    """Raise UsageError if a file's suffix is not that of a picture, or its directory is missing."""
    formats = sorted(FigureCanvasBase.get_supported_filetypes())
    if path.suffix.removeprefix(".") not in formats:
        raise UsageError(f"--plot must end in one of {', '.join(formats)}, got {path}")
    if path.exists() and not path.is_file():  # writing into a pipe could wait forever
        raise UsageError(f"--plot must be a file, got {path}")
    if not path.parent.is_dir():
        raise UsageError(f"--plot must be in a directory that is there, got {path}")


def plot_front(front: FrontOfAnyKind, path: Path, noun: str = "tours") -> None:
    """Draw the lengths of a front into a file, the first to the right and the second up."""
    figure = Figure(figsize=(6, 4.5), layout="constrained")
    axes = figure.add_subplot()
    first, second = front.lengths.T
    axes.step(first, second, where="post", color="0.8", linewidth=1)
    axes.scatter(first, second, s=14)
    for label, text in zip((axes.xaxis.label, axes.yaxis.label), labels_of(front), strict=True):
        label.set(text=text, parse_math=False)  # a name may have a dollar sign in it
    axes.set_title(f"{len(front.lengths)} {noun}, hypervolume {front.hypervolume:.2%}")
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, dpi=150)
