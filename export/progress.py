"""Print what a long command does: a line for each step, with the seconds since its start."""

import time


class Progress:
    """Lines on standard output, each printed when a step begins."""

    def __init__(self) -> None:
        self._began = time.monotonic()

    def begin(self, step: str) -> None:
        """Print that a step begins."""
        print(f"{time.monotonic() - self._began:6.1f} s  {step}", flush=True)

    def detail(self, part: str) -> None:
        """Print that a part of the step begins."""
        self.begin(f"  {part}")
