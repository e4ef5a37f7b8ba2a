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
        for row, vehicle in enumerate(vehicles):
            amounts = [columns.tried(_IF_WRONG, columns.amount, row, at) for at in found]
            vehicle["capacity"] = [int(amount * units) for amount in amounts]
    else:
        _hold_all(columns, vehicles, all_demand(stops))
    if "initial_load" in columns.fields:
        found = _columns_of(columns, "initial_load", visits, demands)
        for row, vehicle in enumerate(vehicles):
            _add_initial_load(columns, row, found, vehicle, units)


def _hold_all(columns: Columns, vehicles: list[Vehicle], demand: list[int]) -> None:
    """Let each vehicle hold all demand, and note it."""
    text = f"No column has a capacity: each vehicle holds all demand, {numbers(demand)}."
    columns.source.note("vehicle", text)
    for vehicle in vehicles:
        vehicle["capacity"] = demand


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


def _add_initial_load(
    columns: Columns, row: int, found: list[int], vehicle: Vehicle, units: int
) -> None:
    """Add the load on board at the start, where a field has one."""
    filled = [at for at in found if columns.text(row, at)]
    if not filled:
        return
    load = [
        columns.tried(0.0, columns.amount, row, at) * units if at in filled else 0.0 for at in found
    ]
    for at, loaded, most in zip(found, load, vehicle["capacity"], strict=True):
        if loaded > most:
            came = f"{loaded / units:g}"
            columns.refuse(row, at, "load-over-capacity", limit=most / units, came=came)
    vehicle["initial_load"] = [int(each) for each in load]
