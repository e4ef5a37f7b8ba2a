"""What a training run shows while it goes and leaves beside its checkpoint."""

import csv
import json
from dataclasses import asdict, dataclass
from pathlib import Path
from types import TracebackType

import matplotlib.pyplot as plt
from tqdm import tqdm

from models.checkpoint import Run
from models.config import as_plain


@dataclass(frozen=True)
class Step:
    """What one step measured, means over its tours."""

    loss: float
    objective: float
    violation: float
    multiplier: float


class Record:
    """A progress bar, `config.json`, `log.csv` (a line a validation) and `curve.png`."""

    def __init__(self, out: Path, run: Run, steps: int) -> None:
        out.mkdir(parents=True, exist_ok=True)
        (out / "config.json").write_text(json.dumps(as_plain(run.config), indent=2) + "\n")
        self._out, self._run = out, run
        self._steps: list[Step] = []
        self._bar = tqdm(total=steps, initial=run.step, unit="step", dynamic_ncols=True)
        self._hypervolumes = ""

    def __enter__(self) -> "Record":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._bar.close()

    def stepped(self, step: Step) -> None:
        """After each step."""
        self._steps.append(step)
        shown = " ".join(f"{name} {value:.3g}" for name, value in asdict(step).items())
        self._bar.set_postfix_str(f"{shown} {self._hypervolumes}", refresh=False)
        self._bar.update()

    def validated(self, hypervolumes: dict[int, float]) -> None:
        """After each validation: mean hypervolume by number of cities."""
        self._hypervolumes = " ".join(f"hv{n} {100 * hv:.2f}" for n, hv in hypervolumes.items())
        self._append_line(hypervolumes)
        self._draw_curve()

    def _append_line(self, hypervolumes: dict[int, float]) -> None:
        line: dict[str, object] = {"step": self._run.step, "seconds": f"{self._run.seconds:.1f}"}
        line |= {
            name: f"{sum(getattr(s, name) for s in self._steps) / len(self._steps):.6g}"
            for name in Step.__dataclass_fields__
        }
        line |= {f"hypervolume_{n}": f"{hv:.6f}" for n, hv in hypervolumes.items()}
        self._steps.clear()
        path = self._out / "log.csv"
        new = not path.exists()
        with path.open("a", newline="") as file:
            writer = csv.DictWriter(file, line)
            if new:
                writer.writeheader()
            writer.writerow(line)

    def _draw_curve(self) -> None:
        with (self._out / "log.csv").open(newline="") as file:
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
