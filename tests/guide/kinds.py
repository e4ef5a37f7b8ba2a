"""The kinds of plans for the page, made of the service's table of them."""

import json
from typing import Any

from service.kinds.kind import Kind
from service.kinds.table import KINDS
from tests.guide.pages import ROOT

TABLE = ROOT / "service/page/common/kinds_table.js"
_HEAD = """\
/** The kinds of plans by name, written by `python -m tests.guide`: see service/kinds/kind.py. */
export const KINDS = {
"""


def kinds_file() -> str:
    """Return the module of the page with what it needs to know of each kind of plan."""
    rows = (f"  {name}: {json.dumps(_row(kind))},\n" for name, kind in KINDS.items())
    return f"{_HEAD}{''.join(rows)}}};\n"


def _row(kind: Kind[Any]) -> dict[str, Any]:
    names = ("path", "call", "item", "mover", "visits", "stops")
    return {**{name: getattr(kind, name) for name in names}, "onGrid": kind.on_grid}
