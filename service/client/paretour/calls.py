"""The calls of the service's HTTP interface. The clients send their requests.

A call is a generator: it yields a request, is sent the response, and returns the call's result.
Both clients run the same calls, one waiting for responses and one awaiting them.
"""

from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeVar

import httpx
from paretour.bodies import ACCEPTED
from paretour.choice import Choice, parameters
from paretour.errors import RETRY_STATUSES, Refused, refused, retry_after
from paretour.events import JobEvents
from paretour.expect import Members, UnexpectedAnswer, each, members, parse_json, text, unexpected
from paretour.kinds import FrontOfAnyKind
from paretour.requests import Plan, front_path
from paretour.values import FINAL_STATUSES, Actor, Tour, parse_actor, parse_tour

T = TypeVar("T")
AnyFront = TypeVar("AnyFront", bound=FrontOfAnyKind)
Parse = Callable[[Mapping[str, Any]], AnyFront]
Geometry = Literal["straight", "roads"]


@dataclass(frozen=True, kw_only=True)
class HttpRequest:
    """A request to send after `delay` seconds, and to wait `timeout` seconds for its response.

    `content` holds the parameters, headers and body for httpx.
    """

    method: str
    path: str
    content: Mapping[str, Any]
    timeout: float
    delay: float = 0.0

    @property
    def arguments(self) -> dict[str, Any]:
        """The keyword arguments of httpx.Client.request."""
        return {"method": self.method, "url": self.path, "timeout": self.timeout, **self.content}


Call = Generator[HttpRequest, httpx.Response, T]


@dataclass(frozen=True, kw_only=True)
class Calls:
    """The calls of a client with this timeout and patience.

    Args:
        timeout: Seconds to wait for a response, beyond those that the search may take.
        patience: Seconds, in all, to wait and retry a call when the service asks for it (429, 503)
            before Refused is raised.
    """

    timeout: float
    patience: float

    def plan(self, plan: Plan, parse: Parse[AnyFront]) -> Call[AnyFront]:
        """Plan a front and wait for it, parsed so."""
        return parse(_answer((yield from self._post(plan, self.timeout + plan.seconds))).document)

    def submit(self, plan: Plan) -> Call[str]:
        """Submit a job that plans a front; return the front's id."""
        response = yield from self._post(plan, self.timeout, Prefer="respond-async")
        return _answer(response).read("id", text)

    def stored(self, front_id: str, parse: Parse[AnyFront]) -> Call[AnyFront]:
        """Return a front as it is now, parsed by `parse`."""
        return parse(_answer((yield from self._get(front_path(front_id)))).document)

    def result(self, front_id: str, parse: Parse[AnyFront]) -> Call[AnyFront]:
        """Return the front of a job that has ended, parsed by `parse`.

        Raises:
            Refused: The job failed.
        """
        answer = _answer((yield from self._get(front_path(front_id))))
        if answer.read("status", text) == "failed":
            raise Refused(answer.read("problem", members).document)
        return parse(answer.document)

    def cancel(self, front_id: str, parse: Parse[AnyFront]) -> Call[AnyFront]:
        """Cancel a job; return its front at the end, parsed by `parse`."""
        front = yield from self.stored(front_id, parse)
        if front.status in FINAL_STATUSES:  # deleting a finished front would remove it
            return front
        response = yield from self._send(self._delete(front_id))
        if response.status_code == httpx.codes.NO_CONTENT:  # it ended meanwhile
            return front
        return parse(_answer(response).document)

    def forget(self, front_id: str) -> Call[None]:
        """Delete the front of a job that has ended."""
        yield from self._send(self._delete(front_id))

    def tour(self, angle: float | None, front_id: str | None, choice: Choice) -> Call[Tour]:
        """Return a tour at an angle in degrees, or of another choice."""
        params = parameters(angle, choice) | ({} if front_id is None else {"front": front_id})
        return parse_tour(_answer((yield from self._get("/tour", params))).document)

    def geojson(self, front_id: str, geometry: Geometry, plan: int | None) -> Call[dict[str, Any]]:
        """Return a front, or one plan of it, as GeoJSON."""
        headers = {"Accept": "application/geo+json"}
        query = {"geometry": geometry} if plan is None else {"geometry": geometry, "plan": plan}
        answer = _answer((yield from self._get(front_path(front_id), query, headers)))
        if (kind := answer.read("type", text)) != "FeatureCollection":
            raise unexpected("answer/type", "FeatureCollection", kind)
        return dict(answer.document)

    def actors(self) -> Call[tuple[Actor, ...]]:
        """Return the actors that the service has loaded."""
        return _answer((yield from self._get("/actors"))).read("actors", each(parse_actor))

    def events(self, front_id: str) -> JobEvents:
        """Return the events of a job, before the first one is read."""
        return JobEvents(front_id, self.timeout, self.patience)

    def _send(self, request: HttpRequest) -> Call[httpx.Response]:
        """Send a request, again while the service asks for that, and return the response.

        Raises:
            Refused: The last response is an error.
        """
        waited = 0.0
        while (response := (yield request)).status_code in RETRY_STATUSES:
            request = replace(request, delay=retry_after(response))
            waited += request.delay
            if waited > self.patience:
                break
        if response.is_success:
            return response
        raise refused(response)

    def _get(
        self,
        path: str,
        params: Mapping[str, Any] | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> Call[httpx.Response]:
        content = {"params": params, "headers": headers}
        request = HttpRequest(method="GET", path=path, content=content, timeout=self.timeout)
        return (yield from self._send(request))

    def _delete(self, front_id: str) -> HttpRequest:
        path = front_path(front_id)
        return HttpRequest(method="DELETE", path=path, content={}, timeout=self.timeout)

    def _post(self, plan: Plan, timeout: float, **headers: str) -> Call[httpx.Response]:
        body = plan.body
        content = {**body, "headers": {**body.get("headers", {}), **headers}}
        request = HttpRequest(method="POST", path=plan.path, content=content, timeout=timeout)
        return (yield from self._send(request))


def client_headers(api_key: str | None) -> dict[str, str]:
    """Return the headers of every request: the accepted encoding, and the API key if any."""
    return ACCEPTED if api_key is None else {**ACCEPTED, "Authorization": f"Bearer {api_key}"}


def _answer(response: httpx.Response) -> Members:
    """Return the members of the JSON object that a response holds.

    Raises:
        UnexpectedAnswer: It does not hold a JSON object.
    """
    content_type = response.headers.get("content-type", "").partition(";")[0].strip().lower()
    if content_type and not content_type.endswith("json"):
        start = f"{content_type!r:.80} with {response.content[:60]!r}"
        raise UnexpectedAnswer(f"answer must be JSON, got {start}")
    return parse_json(response.content, "answer")
