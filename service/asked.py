"""What work asks for, whichever path it came by."""

from typing import Any

import numpy as np

from service.covering import CoverageRequest, parse_coverage_request
from service.messages import Work
from service.rendered import Rendered
from service.requests import parse_front_request
from service.schemas import FrontRequest, Limits


def parse(work: Work, limits: Limits) -> FrontRequest | CoverageRequest:
    """The request in a piece of work.

    Raises:
        Refusal: it is none, or over a limit.
    """
    if work.kind == "coverage":
        return parse_coverage_request(work.body, limits, work.upload)
    return parse_front_request(work.body, limits, work.upload)


def nothing_yet(asked: FrontRequest | CoverageRequest, actor: dict[str, str]) -> Rendered:
    """The front before anything is found.

    Raises:
        InvalidInstance: there is nothing to be found.
    """
    if isinstance(asked, CoverageRequest):
        asked.coverage()
        # What the places cost, and with a spacing which they are, is for a worker to find.
        known = {"cities": len(asked.places), "scale": None, "places": asked.places}
        reference_point = asked.reference_point or None
    else:
        instance = asked.instance()
        known = {"cities": instance.n, "scale": instance.scale.tolist()}
        reference_point = asked.reference_point or (instance.n * instance.scale).tolist()
    members: dict[str, Any] = {
        **known,
        "points": 0,
        "hypervolume": 0.0,
        "hypervolume_bound": None,
        "reference_point": reference_point,
        "timings_ms": {},
        "terminated": None,
        "actor": actor,
    }
    return Rendered(members, b"", np.empty(0, np.int64), np.empty(0))
