"""The one table of codes of refusals: the status, sentence and operations of each.

Exception handlers, the HTTP reference and the guide are made from it. A code is stable, its
sentence is not.
"""

from collections.abc import Mapping
from typing import NamedTuple

_ALL = ("*",)
_NONE = ()  # codes about the path, the method or the service, not about an operation
_REPLAN = ("POST /front/{id}/replan",)
_OFFERS = ("POST /front/{id}/offers",)
_FLEET = ("POST /fleet",)
_PLANNED = ("POST /front", "POST /coverage", *_REPLAN)
_PLANS = (*_PLANNED, *_FLEET)
_FILES = ("POST /files",)
_BODIES = (*_PLANS, *_OFFERS, *_FILES)
_TOUR = ("GET /tour",)
_QUESTIONS = "GET /front/{id}/questions"
_LIST = "GET /front"
_STORED = "GET /front/{id}"
_ROADS = ("POST /front", *_FLEET, *_REPLAN, *_OFFERS, _STORED, *_TOUR)


class Problem(NamedTuple):
    """The status of a code, its sentence with fields to fill in, and the operations that use it."""

    status: int
    sentence: str
    operations: tuple[str, ...] = _ALL

    def concerns(self, operation: str) -> bool:
        """Return whether an operation, as "POST /front", may answer with this code."""
        return self.operations == _ALL or operation in self.operations


PROBLEMS: Mapping[str, Problem] = {
    "malformed-http": Problem(400, "the request must be HTTP/1.1: {reason}", _NONE),
    "malformed-json": Problem(400, "the body must be JSON: {reason}", (*_PLANS, *_OFFERS)),
    "malformed-multipart": Problem(400, "the body must be multipart/form-data: {reason}", _BODIES),
    "unauthorized": Problem(401, "{reason}"),
    "no-front": Problem(
        404, "there is no front to choose a tour from: plan one with POST /front", _TOUR
    ),
    "no-such-path": Problem(404, "there is nothing at {path}; {docs} says what is", _NONE),
    "no-such-tour": Problem(
        404,
        "no tour has a {which} length of at most {limit:.16g}: the least is {actual:.16g}",
        _TOUR,
    ),
    "no-tour": Problem(
        404, "front {front} must have a tour, and has none yet", (*_TOUR, _QUESTIONS)
    ),
    "no-tours": Problem(
        404, "front {front} has plans of a fleet, not tours: read the whole front", _TOUR
    ),
    "unknown-front": Problem(404, "there is no front {front}"),
    "no-locations": Problem(
        406,
        "GeoJSON needs a location of every stop, got {came}",
        (*_PLANS, _STORED, *_TOUR),
    ),
    "method-not-allowed": Problem(405, "{path} must be asked with {allowed}, got {came}", _NONE),
    "body-too-slow": Problem(408, "the body must arrive within {limit:g} s, and has not"),
    "head-too-slow": Problem(
        408, "the head of a request must arrive within {limit:g} s, and has not", _NONE
    ),
    "not-replannable": Problem(
        409,
        "front {front} must be one that can be replanned, and is not: {reason}",
        (*_REPLAN, *_OFFERS),
    ),
    "no-offers": Problem(
        409,
        "front {front} must have plans of a fleet, as only stops of a fleet have windows: plan its"
        " stops with POST /fleet, and one vehicle",
        _OFFERS,
    ),
    "front-unfinished": Problem(
        409,
        "front {front} must be finished, as questions are about a front that stays as it is, and"
        " is {status}",
        (_QUESTIONS,),
    ),
    "front-expired": Problem(410, "front {front} is no longer kept: plan it again"),
    "body-too-long": Problem(413, "the body must have at most {limit} bytes, got {came}"),
    "body-too-complex": Problem(413, "the body must {demand}", _BODIES),
    "file-too-large": Problem(413, "{detail}", _FILES),
    "too-many-cells": Problem(
        413, "grid must have at most {limit} cells, got {came}", ("POST /coverage",)
    ),
    "too-many-cities": Problem(413, "{detail}"),
    "too-many-for-network": Problem(
        413,
        "{name} needs tours of a network, which builds tours of at most {limit} cities, got"
        " {actual}: give a time_limit above 0 and no preferences",
        _PLANNED,
    ),
    "not-json": Problem(
        415, "Content-Type must be application/json or multipart/form-data, got {came}"
    ),
    "not-files": Problem(415, "Content-Type must be multipart/form-data, got {came}", _FILES),
    "not-plain": Problem(415, "Content-Encoding must be identity, got {came}"),
    "unsatisfiable-range": Problem(416, "the range must be within the file", _NONE),
    "idempotency-mismatch": Problem(422, "this Idempotency-Key was used with another body", _PLANS),
    "invalid-instance": Problem(422, "{reason}", _PLANS),
    "invalid-parts": Problem(422, "{reason}", _BODIES),
    "invalid-request": Problem(
        422, "{detail}", (*_PLANS, *_OFFERS, _LIST, _STORED, _QUESTIONS, *_TOUR)
    ),
    "no-plan": Problem(422, "{reason}", (*_PLANS, *_OFFERS)),
    "no-actor": Problem(422, "{kind} need an actor that reads them, and none is loaded", _PLANS),
    "no-repairs": Problem(
        422, "repairs must be 0 for {name}, which cannot repair tours, got {came}", _PLANNED
    ),
    "no-router": Problem(
        422, "{name} {measure} needs a routing engine, and none is configured", _ROADS
    ),
    "no-traffic": Problem(
        422,
        "{name} needs a routing engine that has historical traffic, and none is configured",
        _ROADS,
    ),
    "no-road": Problem(422, "{detail}", _ROADS),
    "off-road": Problem(422, "{detail}", _ROADS),
    "paths-too-long": Problem(
        422,
        "paths must have at most {limit} cells, got {actual}: {advice}",
        ("POST /coverage", *_REPLAN),
    ),
    "survey-too-long": Problem(
        422,
        "the paths between {places} places over {cells} free cells must be found within {limit:g}"
        " s of a processor, and take longer: give about {fitting} places, larger cells, or a longer"
        " time_limit",
        ("POST /coverage", *_REPLAN),
    ),
    "over-limit": Problem(
        422, "{name} must be at most {limit:g}, got {actual:g}", (*_PLANS, *_OFFERS)
    ),
    "streets-too-long": Problem(
        422,
        "the streets of an answer must have at most {limit} {parts}: ask for fewer tours, or one",
        _ROADS,
    ),
    "too-different": Problem(
        422,
        "a tour must keep at least {limit:.6g} of the driven one's legs: the most is {actual:.6g}",
        _REPLAN,
    ),
    "unreadable-file": Problem(422, "{detail}", _FILES),
    "unfit-actor": Problem(
        422, "actor must read {kind}, as {among}; {name} reads {inputs} alone", _PLANS
    ),
    "unknown-actor": Problem(422, "actor must be {among}, got {came}", _PLANS),
    "hidden-client": Problem(
        422,
        "your own fronts are those of your key or your address, and a proxy that"
        " FORWARDED_ALLOW_IPS does not name hides your address: name a front by its id",
        (_LIST, *_TOUR),
    ),
    "webhook-not-allowed": Problem(
        422, "Webhook-Url must lead where the operator allows webhooks, got {came}", _PLANS
    ),
    "preflight-refused": Problem(
        400, "a page may call from an allowed origin, with its method and headers: {reason}", _NONE
    ),
    "refused": Problem(400, "{detail}", _NONE),
    "rate-limited": Problem(
        429, "requests must be at most {rate}, and {caller} made more: wait {wait} s"
    ),
    "extension-failed": Problem(
        500,
        "{extension}, which the operator added, {fault}: this is not a fault of the request",
        _NONE,
    ),
    "internal-error": Problem(500, "this is a fault of the service, not of the request", _NONE),
    "router-unusable": Problem(
        502, "the routing engine must answer as documented, and does not: {reason}", _ROADS
    ),
    "bodies-full": Problem(
        503,
        "the bodies of all requests in progress must fit into {limit} bytes: ask again",
        (*_BODIES, _STORED),
    ),
    "no-worker": Problem(
        503, "a worker must be running, and none is: {reason}", ("GET /health/ready", *_BODIES)
    ),
    "queue-full": Problem(
        503, "the queue must have a free place, and all are taken: ask again", _BODIES
    ),
    "router-unavailable": Problem(
        503, "the routing engine must answer, and does not: ask again", _ROADS
    ),
    "share-full": Problem(
        503,
        "a caller may have {limit} fronts waiting or being planned, and has that many: ask again",
        _PLANS,
    ),
    "shutting-down": Problem(503, "the server is shutting down"),
    "stopped": Problem(503, "the work was stopped before there was a front", _PLANS),
    "store-unavailable": Problem(503, "the store of fronts does not answer"),
    "too-many-connections": Problem(
        503, "all connections, or all that one address may have, are busy: ask again", _NONE
    ),
    "warming-up": Problem(
        503,
        "{progress}: ask again, or for the network alone, with time_limit and repairs 0",
        (*_PLANS, "GET /health/ready"),
    ),
    "worker-lost": Problem(
        503, "two worker processes were lost while they planned this request", _PLANS
    ),
    "router-too-slow": Problem(
        504,
        "the routing engine must answer within {limit:g} s, and has not: bring fewer stops",
        _ROADS,
    ),
    "overdue": Problem(504, "the work must end in time, and there was no front yet", _PLANS),
}
