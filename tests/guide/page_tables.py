"""Tables for the page, made of the service's own: kinds of plans, and measures of fleets."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from service.fleet.measures.table import MEASURES, TRADED, PlanMeasure
from service.kinds.kind import Kind
from service.kinds.table import KINDS
from tests.guide.pages import ROOT

_COMMON = ROOT / "service/page/common"
_WRITTEN = "written by `python -m tests.guide`: see"


def page_tables() -> dict[Path, str]:
    """Return the modules of the page with what it needs to know of each kind and each measure."""
    kinds = {name: _of_kind(kind) for name, kind in KINDS.items()}
    measures = {name: _of_measure(measure) for name, measure in MEASURES.items()}
    choices = {name: each.choice for name, each in TRADED.items() if each.choice}
    return {
        _COMMON / "kinds_table.js": f"/** The kinds of plans by name, {_WRITTEN}"
        f" service/kinds/kind.py. */\n{_table('KINDS', kinds)}",
        _COMMON / "measures_table.js": f"/** The measures of plans by name, {_WRITTEN}"
        f" service/fleet/measures/table.py. */\n{_table('MEASURES', measures)}\n"
        "/** The measures that the page offers as objectives, with the columns that they need. */\n"
        f"{_table('CHOICES', choices)}",
    }


def _table(name: str, rows: Mapping[str, Any]) -> str:
    lines = (f"  {key}: {json.dumps(row)},\n" for key, row in rows.items())
    return f"export const {name} = {{\n{''.join(lines)}}};\n"


def _of_kind(kind: Kind[Any]) -> dict[str, Any]:
    names = ("path", "item", "mover", "visits", "stops")
    return {**{name: getattr(kind, name) for name in names}, "onGrid": kind.on_grid}


def _of_measure(measure: PlanMeasure) -> dict[str, Any]:
    known = {"ofPlan": measure.of_plan, "note": measure.note, "column": measure.column}
    some = {name: value for name, value in known.items() if value}
    return {"title": measure.title, "unit": measure.unit, **some}
