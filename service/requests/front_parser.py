"""Parse and check the requests of `POST /front`, in each of their forms."""

from collections.abc import Mapping, Sequence
from typing import TypeVar

from service.errors import Refusal, invalid
from service.requests.arrays import check_costs
from service.requests.front import FORMS, FrontRequest
from service.requests.limits import Limits, check_limits, check_router, lower_defaults
from service.requests.npy import read_npy
from service.requests.schemas import LARGEST
from service.requests.stop_fields import find_index
from service.requests.validation import parse_json, too_many_cities

_REFERENCES = {"start", "end", "initial_tours"}  # the fields that may name stops by their ids
AnyFrontRequest = TypeVar("AnyFrontRequest", bound=FrontRequest)


def parse_front_request(body: bytes, limits: Limits, npy: bytes | None = None) -> FrontRequest:
    """Return the request in a JSON body, with the matrices of a .npy file where one came with it.

    Raises:
        Refusal: The body is not JSON, misses the schema or is over a limit.
    """
    return parse_front_as(FrontRequest, body, limits, npy)


def parse_front_as(
    model: type[AnyFrontRequest], body: bytes, limits: Limits, npy: bytes | None
) -> AnyFrontRequest:
    """Return a request of a class, as `parse_front_request` does."""
    request = parse_json(model, body)
    _check_form(request, npy is not None)
    if npy is not None:
        request = request.model_copy(
            update={"matrices": read_npy(npy, limits.most_cities("matrices"))}
        )
    _check_cities(request, limits)
    request = _by_index(request)
    n, id_bytes = request.n, 0 if request.labels is None else request.labels.id_bytes
    check_limits(request, n, limits, id_bytes)
    return lower_defaults(request, n, limits, id_bytes)


def _check_form(request: FrontRequest, with_file: bool) -> None:
    """Raise a refusal unless the cities come in one form; stops may have matrices in a file."""
    given = request.model_fields_set
    if with_file and "matrices" in given:
        raise invalid("matrices", "must come once, got them as a part as well")
    forms = [form for form in FORMS if form in given]
    if with_file and "stops" not in forms:
        forms.append("matrices")
    if len(forms) != 1:
        came = " and ".join(forms) or "none"
        sentence = f"one of {', '.join(FORMS[:-1])} and {FORMS[-1]} is required, got {came}"
        raise Refusal("invalid-request", detail=sentence, pointer=f"/{(forms or FORMS)[0]}")
    if ("stops" in given) != ("objectives" in given):
        missing, there = ("objectives", "stops") if "stops" in given else ("stops", "objectives")
        raise invalid(missing, f"is required with {there}")


def _check_cities(request: FrontRequest, limits: Limits) -> None:
    form = "stops" if request.stops else request.kind
    # The larger limit first: the kind of stops is known only after their costs are read.
    if request.n > limits.cities:
        raise too_many_cities(form, limits.cities, request.n)
    most = limits.most_cities("matrices")
    if request.n > most and request.kind == "matrices":
        condition = " unless both objectives have coordinates" if request.stops else ""
        raise too_many_cities(form, most, request.n, condition)
    if request.matrices.size:
        _check_matrices(request)
    if request.stops:
        check_router(request.sources, limits)


def _check_matrices(request: FrontRequest) -> None:
    rows = request.matrices.shape[1]
    if request.stops and rows != request.n:
        raise invalid("matrices", f"must have {request.n} rows, one for each stop, got {rows}")
    for m, matrix in enumerate(request.matrices):
        check_costs(matrix, f"matrices/{m}", LARGEST)


def _by_index(request: AnyFrontRequest) -> AnyFrontRequest:
    """Return the request with the index of a stop in place of every id."""
    if not request.model_fields_set & _REFERENCES:
        return request
    stops = request.labels.stops if request.labels else ()
    ids = {stop.id: index for index, stop in enumerate(stops)}
    tours = [
        _indexes(tour, ids, f"initial_tours/{number}")
        for number, tour in enumerate(request.initial_tours)
    ]
    ends = {
        name: None if reference is None else find_index(reference, ids, name)
        for name, reference in (("start", request.start), ("end", request.end))
    }
    found = {**ends, "initial_tours": tours}
    given = request.model_fields_set
    return request.model_copy(update={name: found[name] for name in found if name in given})


def _indexes(references: Sequence[int | str], ids: Mapping[str, int], part: str) -> list[int]:
    return [
        each if isinstance(each, int) else find_index(each, ids, f"{part}/{i}")
        for i, each in enumerate(references)
    ]
