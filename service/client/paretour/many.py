"""Plan many fronts in several processes, each as `plan` does."""

from collections.abc import Iterable
from concurrent.futures import as_completed
from contextlib import nullcontext
from typing import Any, Unpack, cast

from paretour.bars import bar_class
from paretour.library import whole_package
from paretour.members import FrontRequest
from paretour.requests import front_plan
from paretour.values import Front


class InstanceFailed(Exception):
    """One of many instances could not be planned. Its cause is what `plan` raises for it.

    Attributes:
        index: The number of the instance, from 0.
    """

    def __init__(self, index: int, reason: str) -> None:
        super().__init__(index, reason)
        self.index = index
        self.reason = reason

    def __str__(self) -> str:
        return f"instance {self.index}: {self.reason}"


def plan_many(
    instances: Iterable[FrontRequest],
    *,
    workers: int | None = None,
    progress: bool = False,
    **options: Unpack[FrontRequest],
) -> list[Front]:
    """Plan a front of each instance in several processes, and return them in order.

    Args:
        instances: The members of each request, as of `plan`.
        workers: The number of processes; by default one for each processor.
        progress: Whether to show a bar, which needs tqdm.
        **options: Members of all requests that lack them, as `time_limit`.

    Raises:
        InstanceFailed: An instance cannot be planned; the others are given up.
        KeyboardInterrupt: Ctrl-C was pressed; all are given up.
        ModuleNotFoundError: Only the client is installed, or tqdm is not.
    """
    requests = [cast(FrontRequest, {**options, **each}) for each in instances]
    fronts: list[Any] = [None] * len(requests)
    bars: Any = bar_class()(total=len(requests), desc="planning") if progress else nullcontext()
    with whole_package("service.library.crew").Crew(workers, len(requests)) as crew, bars as bar:

        def run(request: FrontRequest) -> Front:
            return cast(Front, crew.run(front_plan(request)))

        numbers = {crew.submit(run, request): index for index, request in enumerate(requests)}
        for future in as_completed(numbers):
            index = numbers[future]
            if (error := future.exception()) is not None:
                raise InstanceFailed(index, str(error)) from error
            fronts[index] = future.result()
            if bar is not None:
                bar.update()
    return fronts
