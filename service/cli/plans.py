"""Build the plan that files and options ask for together."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

from paretour import CoverageRequest, FrontRequest, Plan, coverage_plan, front_plan

from service.cli.errors import UsageError
from service.cli.files import read_layer, read_map, read_request

Options = Mapping[str, Any]  # members of a request; None leaves a member to the file


def plan_cities(
    file: Path,
    file2: Path | None = None,
    *,
    unrounded: bool = False,
    angles: str | None = None,
    options: Options,
) -> Plan:
    """Return the plan for cities in a file, or in one for each objective.

    Raises:
        UnreadableFile: A file is not of its format.
        OSError: There is no such file.
        UsageError: `angles` are not numbers with commas between.
    """
    request = read_request([file] if file2 is None else [file, file2], unrounded=unrounded)
    given = _without_none({**options, "preferences": _parse_angles(angles)})
    return front_plan(cast(FrontRequest, {**request, **given}))


def plan_map(file: Path, cost_layer: Path | None, options: Options) -> Plan:
    """Return the plan for places on the map in a file, maybe with costs in another.

    Raises:
        UnreadableFile: A file is not of its format.
        OSError: There is no such file.
    """
    request, png = read_map(file)
    costs = None if cost_layer is None else read_layer(cost_layer)
    given = _without_none({**options, "cost_layer": costs})
    return coverage_plan(cast(CoverageRequest, {**request, **given}), png)


def _parse_angles(text: str | None) -> list[float] | None:
    try:
        return None if text is None else [float(angle) for angle in text.split(",")]
    except ValueError:
        sentence = f"--angles must be numbers with commas between, got {text!r}"
        raise UsageError(sentence) from None


def _without_none(options: Options) -> dict[str, Any]:
    return {name: value for name, value in options.items() if value is not None}
