"""Read the columns of a table of vehicles that are about loads: capacities, and initial loads."""

from service.files.columns import Columns
from service.files.fleets import Stop, Vehicle, all_loads, numbers
from service.files.visits import in_order, loads_in

_IF_WRONG = 1e15  # in place of a capacity that is wrong: no initial load is more


def add_loads(
    columns: Columns, vehicles: list[Vehicle], visits: Columns, stops: list[Stop], units: int
) -> None:
    """Add capacities and initial loads, in the units and order of the demands.

    Without a column of capacity, each vehicle holds all demand.

    Raises:
        UnreadableFile: There are not as many columns as demands, or a load exceeds a capacity.
    """
    demands, pickups = loads_in(visits)
    names = [visits.names[at] for at in demands or pickups]
    if not names:
        for field in columns.fields:
            if field in ("capacity", "initial_load"):
                columns.leave_out(field, " without demands of stops")
        return
    if "capacity" in columns.fields:
        found = in_order(columns, "capacity", names, visits.source.name)
        capacities = [_capacity(columns, row, found, units) for row in range(len(vehicles))]
    else:
        demand = all_loads(stops)
        text = f"No column has a capacity: each vehicle holds all demand, {numbers(demand)}."
        columns.source.note("vehicle", text)
        capacities = [demand] * len(vehicles)
    carries = "initial_load" in columns.fields
    found = in_order(columns, "initial_load", names, visits.source.name) if carries else []
    for row, (vehicle, capacity) in enumerate(zip(vehicles, capacities, strict=True)):
        vehicle["capacity"] = capacity
        if load := _initial_load(columns, row, found, capacity, units):
            vehicle["initial_load"] = load


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
