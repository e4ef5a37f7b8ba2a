"""Read the columns of a table of vehicles that are about loads: capacities, and initial loads."""

from service.files.column_names import amount_of
from service.files.columns import Columns
from service.files.fleets import Stop, Vehicle, all_demand, numbers

_IF_WRONG = 1e15  # in place of a capacity that is wrong: no initial load is more


def add_loads(
    columns: Columns, vehicles: list[Vehicle], visits: Columns, stops: list[Stop], units: int
) -> None:
    """Add capacities and initial loads, in the units and order of the demands.

    Without a column of capacity, each vehicle holds all demand.

    Raises:
        UnreadableFile: There are not as many columns as demands, or a load exceeds a capacity.
    """
    demands = [at for at, each in enumerate(visits.fields) if each == "demand"]
    if not demands:
        for field in columns.fields:
            if field in ("capacity", "initial_load"):
                columns.leave_out(field, " without demands of stops")
        return
    if "capacity" in columns.fields:
        found = _columns_of(columns, "capacity", visits, demands)
        capacities = [_capacity(columns, row, found, units) for row in range(len(vehicles))]
    else:
        demand = all_demand(stops)
        text = f"No column has a capacity: each vehicle holds all demand, {numbers(demand)}."
        columns.source.note("vehicle", text)
        capacities = [demand] * len(vehicles)
    carries = "initial_load" in columns.fields
    found = _columns_of(columns, "initial_load", visits, demands) if carries else []
    for row, (vehicle, capacity) in enumerate(zip(vehicles, capacities, strict=True)):
        vehicle["capacity"] = capacity
        if load := _initial_load(columns, row, found, capacity, units):
            vehicle["initial_load"] = load


def _columns_of(columns: Columns, field: str, visits: Columns, demands: list[int]) -> list[int]:
    """Return the columns of a field, one for each demand: by their names if both share them."""
    found = [at for at, each in enumerate(columns.fields) if each == field]
    if len(found) != len(demands):
        noun = field.replace("_", " ")
        counts = {"demands": len(demands), "came": len(found)}
        raise columns.source.refusal(
            "column-each-demand", noun=noun, table=visits.source.name, **counts
        )
    amounts = [amount_of(visits.names[at]) for at in demands]
    by_amount = {amount_of(columns.names[at]): at for at in found}
    if by_amount.keys() == set(amounts) and len(by_amount) == len(amounts):
        return [by_amount[amount] for amount in amounts]
    return found


def _capacity(columns: Columns, row: int, found: list[int], units: int) -> list[int]:
    amounts = [columns.tried(_IF_WRONG, columns.amount, row, at) for at in found]
    return [int(amount * units) for amount in amounts]


def _initial_load(
    columns: Columns, row: int, found: list[int], capacity: list[int], units: int
) -> list[int]:
    """Return the load on board at the start; nothing if no field has one."""
    filled = [at for at in found if columns.text(row, at)]
    if not filled:
        return []
    load = [
        columns.tried(0.0, columns.amount, row, at) * units if at in filled else 0.0 for at in found
    ]
    for at, loaded, most in zip(found, load, capacity, strict=True):
        if loaded > most:
            came = f"{loaded / units:g}"
            columns.refuse(row, at, "load-over-capacity", limit=most / units, came=came)
    return [int(each) for each in load]
