"""What work asks for, whichever path it came by."""

from service.covering import CoverageRequest, parse_coverage_request
from service.messages import Work
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
