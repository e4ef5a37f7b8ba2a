"""Read customers with windows, as Solomon, Gehring and Homberger, and Li and Lim write them."""

import re

from service.files.fleets import Shipment, Stop, Vehicle, fleet_request, planar
from service.files.reading import Reading, Source
from service.files.tables import number_in

_WITH_TIMES = 7  # numbers of a customer: id, x, y, demand, ready, due, service
_WITH_PAIRS = 9  # the same, and the ids of its pick-up and delivery


def is_customers(text: str) -> bool:
    """Return whether a text is customers with windows as Solomon or Li and Lim write them."""
    if re.search(r"^[ \t]*VEHICLE[ \t]*$", text, re.MULTILINE) and re.search(
        r"^[ \t]*CUST", text, re.M
    ):
        return True
    rows = [line.split() for line in text[:2000].splitlines() if line.strip()][:2]
    return [len(row) for row in rows] == [3, _WITH_PAIRS] and _numeric([w for r in rows for w in r])


def read_customers(source: Source, text: str) -> Reading:
    """Return the request of customers in a plane. Distances are times as well.

    Raises:
        UnreadableFile: A row does not have the numbers that it must have.
    """
    rows = [
        (at, [number_in(word) or 0.0 for word in line.split()])
        for at, line in enumerate(text.split("\n"), 1)
        if line.strip() and _numeric(line.split())
    ]
    if len(rows) < 2 or len(rows[0][1]) not in (2, 3):
        raise source.refusal("no-customers")
    (_, (count, capacity, *_)), *customers = rows
    width = len(customers[0][1])
    for number, row in customers:
        if len(row) != width or width not in (_WITH_TIMES, _WITH_PAIRS):
            widths = {"numbers": _WITH_TIMES, "with_pairs": _WITH_PAIRS}
            raise source.refusal("numbers-of-customer", row=number, **widths, came=len(row))
    source.check_count("stops", source.bounds.cities, len(customers))
    depot, *others = [row for _, row in customers]
    names = [f"{row[0]:g}" for _, row in customers]
    stops: list[Stop] = [{"id": names[0]}, *(_customer(source, row) for row in others)]
    vehicle: Vehicle = {
        **{"id": "vehicle", "count": int(count), "start": names[0], "end": names[0]},
        "capacity": [_whole(source, capacity, "capacity")],
        "shift": depot[4:6],
    }
    plane = [row[1:3] for _, row in customers]
    objectives = planar({"name": "total length", "coordinates": plane})
    shipments: list[Shipment] | None = None
    if width == _WITH_PAIRS:
        pairs = [(f"{row[0]:g}", f"{row[8]:g}") for row in others if row[8]]
        shipments = [{"pickup": one, "delivery": other} for one, other in pairs]
    source.note("objectives", "Distances are time as well, and are not rounded.")
    return source.reading("fleet", fleet_request(stops, [vehicle], objectives, shipments))


def _customer(source: Source, row: list[float]) -> Stop:
    name = f"{row[0]:g}"
    stop: Stop = {"id": name, "window": row[4:6], "service": row[6]}
    if row[3] >= 0:  # a delivery has the negative demand of its pick-up
        stop["demand"] = [_whole(source, row[3], f"the demand of {name}")]
    return stop


def _whole(source: Source, number: float, what: str) -> int:
    if not number.is_integer():
        raise source.refusal("no-whole-number", what, came=number)
    return int(number)


def _numeric(words: list[str]) -> bool:
    return all(number_in(word) is not None for word in words)
