"""The log of a training run: a progress bar, lines of a CSV file, a curve."""

import csv
import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from types import TracebackType
from typing import TypeVar

import matplotlib.pyplot as plt
from tqdm import tqdm

from models.checkpoint import Run
from models.config import as_plain
from models.steps import StepMeans

L = TypeVar("L", bound="ProgressLog")


class ProgressLog:
    """A progress bar over the steps, and `log.csv` in the folder of a run."""

    def __init__(self, out: Path, steps: int, done: int) -> None:
        out.mkdir(parents=True, exist_ok=True)
        self.path = out / "log.csv"
        self._bar = tqdm(total=steps, initial=done, unit="step", dynamic_ncols=True)

    def __enter__(self: L) -> L:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._bar.close()

    def advance(self, text: str) -> None:
        """Move the bar by one step, with the text beside it."""
        self._bar.set_postfix_str(text, refresh=False)
        self._bar.update()

    def append(self, line: Mapping[str, object]) -> None:
        """Append a line to `log.csv`, of values by column; the first brings the header."""
        new = not self.path.exists()
        with self.path.open("a", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, list(line))
            if new:
                writer.writeheader()
            writer.writerow(line)


class TrainingLog(ProgressLog):
    """The log of an actor's training: a line a validation, `config.json` and `curve.png`."""

    def __init__(self, out: Path, run: Run, steps: int) -> None:
        super().__init__(out, steps, run.step)
        (out / "config.json").write_text(
            json.dumps(as_plain(run.config), indent=2) + "\n", encoding="utf-8"
        )
        self._out, self._run = out, run
        self._steps: list[StepMeans] = []
        self._hypervolumes = ""

    def stepped(self, step: StepMeans) -> None:
        """Report a step."""
        self._steps.append(step)
        shown = " ".join(f"{name} {value:.3g}" for name, value in asdict(step).items())
        self.advance(f"{shown} {self._hypervolumes}")

    def validated(self, hypervolumes: dict[int, float]) -> None:
        """Report a validation: mean hypervolume by number of cities."""
        self._hypervolumes = " ".join(f"hv{n} {100 * hv:.2f}" for n, hv in hypervolumes.items())
        line: dict[str, object] = {"step": self._run.step, "seconds": f"{self._run.seconds:.1f}"}
        line |= {
            name: f"{sum(getattr(s, name) for s in self._steps) / len(self._steps):.6g}"
            for name in StepMeans.__dataclass_fields__
        }
        line |= {f"hypervolume_{n}": f"{hv:.6f}" for n, hv in hypervolumes.items()}
        self._steps.clear()
        self.append(line)
        self._draw_curve()

    def _draw_curve(self) -> None:
        with self.path.open(newline="", encoding="utf-8") as file:
            lines = list(csv.DictReader(file))
        names = [name for name in lines[0] if name.startswith("hypervolume_")]
        figure, panels = plt.subplots(len(names), sharex=True, figsize=(7, 3 * len(names)))
        for panel, name in zip([panels] if len(names) == 1 else panels, names, strict=True):
            panel.plot([int(x["step"]) for x in lines], [100 * float(x[name]) for x in lines])
            panel.set_ylabel(f"hypervolume, {name.removeprefix('hypervolume_')} cities (%)")
            panel.grid(alpha=0.3)
        panel.set_xlabel("step")
        figure.savefig(self._out / "curve.png", dpi=110, bbox_inches="tight")
        plt.close(figure)
