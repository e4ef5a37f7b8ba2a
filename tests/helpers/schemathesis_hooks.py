"""Corrections of schemathesis' requests, for rules that no JSON schema can state."""

import uuid
from typing import Any

import schemathesis

_POSE = {"position": {"x": 0, "y": 0}, "orientation": {"z": 0, "w": 1}}
_MESSAGE = {
    "info": {"resolution": 1, "width": 2, "height": 2, "origin": _POSE},
    "data": [0, 0, 0, 0],
}
_CHOICES = ("angle", "balance", "first_at_most", "second_at_most", "knee")
_BY_NAME = ("weights", "at_most", "prefer")  # of objectives, which a schema does not know


@schemathesis.hook
def filter_case(context: Any, case: Any) -> bool:  # noqa: ARG001
    """Leave out forms, whose bytes no schema describes, and orders, which fit some fleets only."""
    offered = case.path.endswith("/offers") and case.meta.generation.mode.is_positive
    return not offered and case.media_type != "multipart/form-data"


@schemathesis.hook
def before_call(context: Any, case: Any, kwargs: dict[str, Any]) -> None:  # noqa: ARG001
    """Make a request that the schema allows one that the service accepts.

    The rules: a matrix is square; its costs are not negative but on the diagonal; some actors read
    no matrices; an end is one of the cities, and of open routes; a tour visits each of them once;
    stops have ids of their own, and costs as many as they are; places are free cells of a grid; a
    reference point is beyond some tour; what has changed is about the stops of a front; a tour is
    chosen in one way, and picks are of options; a fleet can keep its rules; robots have ids of
    their own; an idempotency key belongs to one body; webhooks go where the operator allows, and
    here nowhere.
    """
    (case.headers or {}).pop("Webhook-Url", None)
    positive = case.meta.generation.mode.is_positive
    if positive:
        _fit_to_fronts(case)
    if (case.query or {}).get("geometry") == "roads":  # there is no routing engine
        case.query["geometry"] = "straight"
    if _is_key((case.headers or {}).get("Idempotency-Key")):
        case.headers["Idempotency-Key"] = uuid.uuid4().hex
    if isinstance(case.body, dict) and _depend_on_objectives(case.body):
        case.body["preferences"] = len(case.body["preferences"])
    _correct_body(case.body, positive=positive)


def _fit_to_fronts(case: Any) -> None:
    """Leave out what not every front has."""
    if case.path == "/tour":
        _choose_in_one_way(case)
    if case.path.endswith("/questions"):
        (case.query or {}).pop("picks", None)  # which are of options that the front has
    if case.path.endswith("/replan"):
        _change_nothing(case.body)
    (case.query or {}).pop("plan", None)  # fronts are of tours


def _correct_body(body: Any, *, positive: bool) -> None:
    match body:
        case {"grid": _} | {"occupancy_grid": _} if positive:
            _make_coverable(body)
        case {"stops": _, "objectives": _, "vehicles": _} if positive:
            _make_drivable(body)
        case {"stops": _, "objectives": _} if positive:
            _make_plannable(body)
        case {"coordinates": [_, *_] as rows}:
            _in_two_planes(body, rows)
        case {"matrices": [[_, *_] as rows, _, *_] as matrices} if _are_matrices(matrices):
            body["matrices"] = [[[1.0] * len(rows)] * len(rows)] * len(matrices)
            if body.get("actor") == "pa-one":
                body["actor"] = "pa-one-matrix"
            _reach(body)
            _fit_to_cities(body, len(rows))


def _in_two_planes(body: dict[str, Any], rows: list[Any]) -> None:
    """Leave only the first two planes of each city."""
    if _is_point(body.get("reference_point")):
        del body["reference_point"]
    if _are_rows(rows):
        body["coordinates"] = [row[:4] for row in rows]
    _fit_to_cities(body, len(rows))


def _change_nothing(body: Any) -> None:
    """Leave only those members of a request to replan that hold for any front, also of a fleet."""
    if isinstance(body, dict):
        for name in set(body) - {"time_limit", "size", "seed"}:
            del body[name]


def _make_coverable(body: dict[str, Any]) -> None:
    """Replace a task of coverage by one that can be done, with the same fields."""
    body["robot_radius"] = 0
    if "robots" in body:
        _share(body)
    else:
        body |= {"start": 0, "actor": "pa-one-matrix"}
    if "cell_size" in body:
        body["cell_size"] = 1
    for name in ("departure", "robot_speed", "over_the_day"):  # they go together
        body.pop(name, None)
    body.pop("initial_tours", None)
    body.pop("start_pose", None)
    body.pop("end_pose", None)
    _reach(body)
    if "grid" in body:
        body["grid"] = [[0, 0], [0, 0]]
    if "occupancy_grid" in body:
        body["occupancy_grid"] = _MESSAGE
    body.pop("end", None)
    n = 2 if "places" in body else 1
    fit = {
        "places": [[0, 0], [1, 1]],
        "spacing": 1e150,
        "second_matrix": [[1.0] * n] * n,
        "cost_layer": [[1.0, 1.0], [1.0, 1.0]],
        "cost_layers": [{"name": "dust", "layer": [[1.0, 1.0], [1.0, 1.0]]}],
        "second_coordinates": [[0.0, 1.0]] * n,
    }
    body |= {name: value for name, value in fit.items() if name in body}


def _share(body: dict[str, Any]) -> None:
    """Replace robots by as many that start at the first place."""
    body["robots"] = [{"id": f"{i}"} for i in range(len(body["robots"]))]
    if "over" in body:
        body["over"] = ["sum", "max"]


def _make_plannable(body: dict[str, Any]) -> None:
    """Replace stops and objectives by such as can be planned, with the same fields.

    Without those about the day, which depend on each other.
    """
    n = len(body["stops"])
    body["stops"] = [{"location": [0.0, 0.0], "id": f"{i}"} for i in range(n)]
    for name in ("departure", "clock"):
        body.pop(name, None)
    for objective in body["objectives"]:
        objective.pop("over_the_day", None)
        for name in ("slices", "breakpoints"):
            if objective.pop(name, None) is not None:
                objective["matrix"] = None
    fit = {
        "matrix": [[1.0] * n] * n,
        "coordinates": [[0.0, 1.0]] * n,
        "from": "great_circle",
        "speed": 3.6,
    }
    body["objectives"] = [
        {name: fit.get(name, f"{m}" if name == "name" else _unit(objective)) for name in objective}
        for m, objective in enumerate(body["objectives"])
    ]
    body |= {"start": "0", "actor": "pa-one-matrix"}
    _reach(body)
    body.pop("end", None)
    if "initial_tours" in body:
        body["initial_tours"] = [[f"{i}" for i in range(n)]]


def _unit(objective: dict[str, Any]) -> str:
    return "s" if "speed" in objective else "m"


def _make_drivable(body: dict[str, Any]) -> None:
    """Replace a fleet by one without rules, of as many stops and types of vehicles."""
    body |= {
        "stops": [{"id": f"{i}", "location": [0.0, 0.0]} for i in range(len(body["stops"]))],
        "vehicles": [{"id": f"{i}", "start": "0"} for i in range(len(body["vehicles"]))],
        "objectives": [{"name": f"{m}", "from": "great_circle"} for m in range(2)],
    }
    for name in ("shipments", "clock"):
        body.pop(name, None)
    _reach(body)


def _choose_in_one_way(case: Any) -> None:
    """Leave one choice of a tour in the query, an angle where there is none."""
    choices = [name for name in _CHOICES if name in (case.query or {})]
    left_out = (*choices[1:], *_BY_NAME)
    case.query = {k: v for k, v in (case.query or {}).items() if k not in left_out}
    if not choices:
        case.query["angle"] = 45


def _reach(body: dict[str, Any]) -> None:
    """Replace a reference point by one beyond all tours."""
    if _is_point(body.get("reference_point")):
        body["reference_point"] = [1e100] * len(body.get("matrices", body.get("objectives", "of")))


def _fit_to_cities(body: dict[str, Any], n: int) -> None:
    """Replace ends and initial tours by such as fit n cities, which have no names."""
    for name, known in (("start", 0), ("end", None)):
        if isinstance(body.get(name), str):
            body[name] = known
    if isinstance(body.get("start"), int | float) and body["start"] >= n:
        body["start"] = 0
    _fit_ends(body, n)
    if _are_tours(body.get("initial_tours")):
        body["initial_tours"] = [list(range(n))]


def _fit_ends(body: dict[str, Any], n: int) -> None:
    """Replace ends by such as n cities can have; routes of initial tours start anywhere."""
    start, end = body.get("start", 0), body.get("end")
    closed = body.get("closed", True)
    if closed is True and start is None:
        body["start"] = 0
    if _is_city(end) and (closed is True or end >= n or end == start):
        body["end"] = None
    if closed is False and _are_tours(body.get("initial_tours")):
        body |= {"start": None, "end": None}


def _is_point(value: Any) -> bool:
    """Whether the schema allows the value as a reference point."""
    return (
        isinstance(value, list)
        and 2 <= len(value) <= 4
        and all(_is_number(length) and 1e-150 <= length <= 1e150 for length in value)
    )


def _are_rows(value: list[Any]) -> bool:
    """Whether the schema allows the value as coordinates."""
    return all(
        isinstance(row, list) and 4 <= len(row) <= 8 and all(map(_is_number, row)) for row in value
    )


def _depend_on_objectives(body: dict[str, Any]) -> bool:
    """Whether preferences are directions, or angles under more than two objectives."""
    preferences = body.get("preferences")
    several = any(
        isinstance(body.get(name), list) and len(body[name]) > 2
        for name in ("objectives", "matrices")
    )
    angles = (
        isinstance(preferences, list)
        and preferences != []
        and all(_is_number(angle) and 0 <= angle <= 90 for angle in preferences)
    )
    return _are_directions(preferences) or (several and angles)


def _are_directions(value: Any) -> bool:
    """Whether the schema allows the value as directions."""
    return (
        isinstance(value, list)
        and value != []
        and all(isinstance(row, list) and 2 <= len(row) <= 4 for row in value)
        and all(_is_number(part) and 0 <= part <= 1e6 for row in value for part in row)
    )


def _are_matrices(value: list[Any]) -> bool:
    """Whether the schema allows the value as matrices."""
    return all(
        isinstance(rows, list)
        and rows != []
        and all(isinstance(row, list) and all(map(_is_cost, row)) for row in rows)
        for rows in value
    )


def _are_tours(value: Any) -> bool:
    """Whether the schema allows the value as tours."""
    return (
        isinstance(value, list)
        and value != []
        and all(isinstance(tour, list) for tour in value)
        and all(_is_city(city) or isinstance(city, str) for tour in value for city in tour)
    )


def _is_key(value: Any) -> bool:
    """Whether the schema allows the value as an idempotency key."""
    return (
        isinstance(value, str) and 0 < len(value) <= 255 and value.isascii() and value.isprintable()
    )


def _is_city(value: Any) -> bool:
    return _is_number(value) and value % 1 == 0 and 0 <= value < 2**31


def _is_cost(value: Any) -> bool:
    return value is None or _is_number(value)


def _is_number(value: Any) -> bool:
    return not isinstance(value, bool) and isinstance(value, int | float)
