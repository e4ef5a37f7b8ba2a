"""The calls of the service's HTTP interface, from arguments to results, without a connection.

A call is a generator: it yields a request, is sent the response, and returns the call's result.
The methods of both clients are these calls; one client waits for the responses, the other awaits
them.
"""

from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeVar, Unpack

import httpx
from paretour.bodies import ACCEPTED, answer_of
from paretour.choice import Choice, parameters
from paretour.errors import RETRY_STATUSES, Refused, refused, retry_after
from paretour.events import JobEvents
from paretour.expect import each, members, text, unexpected, value_of
from paretour.explaining import explaining
from paretour.kinds import FrontOfAnyKind, parse_any
from paretour.listing import PAGE, ListedFront, next_page, parse_listed
from paretour.members import (
    CoverageRequest,
    FleetRequest,
    FrontRequest,
    OffersRequest,
    ReplanFleetRequest,
    ReplanRequest,
    RobotsRequest,
)
from paretour.offers import Offers, parse_offers
from paretour.plans import FleetFront, RobotFront, parse_fleet, parse_robots
from paretour.questions import OPTIONS, QUESTIONS, Question, parse_question
from paretour.requests import (
    Instance,
    Plan,
    PlanOfFiles,
    coverage_plan,
    fleet_plan,
    front_path,
    front_plan,
    offers_plan,
    parts_of,
    replan_plan,
)
from paretour.values import FINAL_STATUSES, Actor, Front, Tour, parse_front, parse_tour

T = TypeVar("T")
AnyFront = TypeVar("AnyFront", bound=FrontOfAnyKind)
Parse = Callable[[Mapping[str, Any]], AnyFront]
Submitted = tuple[str, Parse[AnyFront]]  # the id of a job's front, and the parser of that front
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

    @explaining(FrontRequest)
    def front(
        self, instance: Instance | None = None, /, **request: Unpack[FrontRequest]
    ) -> Call[Front]:
        """Plan a front and wait for it, until its time limit or until nothing more is found.

        Args:
            instance: Coordinates, matrices or stops, unless they are among the members.
            **request: The members of the request.
        """
        return self.plan(front_plan(request, instance))

    @explaining(CoverageRequest)
    def coverage(self, png: bytes | None = None, **request: Unpack[CoverageRequest]) -> Call[Front]:
        """Plan a front over a map and wait for it.

        Args:
            png: The map as the content of a PNG or PGM file, instead of a grid in the request;
                `read_ros_map` reads both from a map.yaml.
            **request: The members of the request.
        """
        return self.plan(coverage_plan(request, png))

    @explaining(ReplanRequest)
    def replan(self, front: Front | str, **request: Unpack[ReplanRequest]) -> Call[Front]:
        """Plan the rest of a tour that is being driven, given what has changed, and wait for it.

        Args:
            front: The front, or its id.
            **request: What has changed, and the options of the new front.
        """
        return self.plan(replan_plan(front, request))

    @explaining(ReplanFleetRequest)
    def replan_fleet(
        self, front: FleetFront | str, **request: Unpack[ReplanFleetRequest]
    ) -> Call[FleetFront]:
        """Plan the rest of a fleet's day, given what has changed, and wait for it.

        Args:
            front: The front, or its id.
            **request: What has changed, and the options of the new front.
        """
        return self.plan_fleet(replan_plan(front, request))

    @explaining(OffersRequest)
    def offers(self, front: FleetFront | str, **request: Unpack[OffersRequest]) -> Call[Offers]:
        """Return in which slots an order can be promised, and what each costs the plan.

        Nothing is changed. `replan_fleet(front, **offer.replan)` takes an offer.

        Args:
            front: The front, or its id.
            **request: The order, the slots, and what has changed.
        """
        plan = offers_plan(front, request)
        return parse_offers(answer_of((yield from self._post(plan, self.timeout + plan.seconds))))

    @explaining(FleetRequest)
    def fleet(self, **request: Unpack[FleetRequest]) -> Call[FleetFront]:
        """Plan a front of plans for a fleet and wait for it."""
        return self.plan_fleet(fleet_plan(request))

    @explaining(RobotsRequest)
    def robots(
        self, png: bytes | None = None, **request: Unpack[RobotsRequest]
    ) -> Call[RobotFront]:
        """Plan a front of plans for several robots that share a map; arguments as of `coverage`."""
        return self.plan_robots(coverage_plan(request, png))

    def plan(self, plan: Plan) -> Call[Front]:
        """Send a plan that was built before, and wait for the front."""
        return self._plan(plan, parse_front)

    def plan_any(self, plan: Plan) -> Call[FrontOfAnyKind]:
        """Send a plan that was built before, and wait for the front, whose kind is not known."""
        return self._plan(plan, parse_any)

    def plan_fleet(self, plan: Plan) -> Call[FleetFront]:
        """Send a plan for a fleet that was built before, and wait for the front of its plans."""
        return self._plan(plan, parse_fleet)

    def plan_robots(self, plan: Plan) -> Call[RobotFront]:
        """Send a plan for robots that was built before, and wait for the front of its plans."""
        return self._plan(plan, parse_robots)

    @explaining(FrontRequest)
    def submit(
        self, *, webhook: str | None = None, **request: Unpack[FrontRequest]
    ) -> Call[Submitted[Front]]:
        """Submit a job that plans a front, and tell the webhook, an address, when it has ended."""
        return self._submit(front_plan(request), parse_front, webhook)

    @explaining(CoverageRequest)
    def submit_coverage(
        self,
        png: bytes | None = None,
        *,
        webhook: str | None = None,
        **request: Unpack[CoverageRequest],
    ) -> Call[Submitted[Front]]:
        """Submit a job that plans a front over a map; arguments as of `coverage` and `submit`."""
        return self._submit(coverage_plan(request, png), parse_front, webhook)

    @explaining(ReplanRequest)
    def submit_replan(
        self, front: Front | str, *, webhook: str | None = None, **request: Unpack[ReplanRequest]
    ) -> Call[Submitted[Front]]:
        """Submit a job that plans the rest of a tour; arguments as of `replan` and `submit`."""
        return self._submit(replan_plan(front, request), parse_front, webhook)

    @explaining(ReplanFleetRequest)
    def submit_replan_fleet(
        self,
        front: FleetFront | str,
        *,
        webhook: str | None = None,
        **request: Unpack[ReplanFleetRequest],
    ) -> Call[Submitted[FleetFront]]:
        """Submit a job for the rest of a day; arguments as of `replan_fleet` and `submit`."""
        return self._submit(replan_plan(front, request), parse_fleet, webhook)

    @explaining(FleetRequest)
    def submit_fleet(
        self, *, webhook: str | None = None, **request: Unpack[FleetRequest]
    ) -> Call[Submitted[FleetFront]]:
        """Submit a job that plans a front of plans for a fleet; `webhook` as of `submit`."""
        return self._submit(fleet_plan(request), parse_fleet, webhook)

    @explaining(RobotsRequest)
    def submit_robots(
        self,
        png: bytes | None = None,
        *,
        webhook: str | None = None,
        **request: Unpack[RobotsRequest],
    ) -> Call[Submitted[RobotFront]]:
        """Submit a job that plans for several robots; arguments as of `coverage` and `submit`."""
        return self._submit(coverage_plan(request, png), parse_robots, webhook)

    def post(self, plan: Plan) -> Call[Submitted[Front]]:
        """Send a plan that was built before, as a job."""
        return self._submit(plan, parse_front)

    def stored(self, front_id: str, parse: Parse[AnyFront]) -> Call[AnyFront]:
        """Return a front as it is now, parsed by `parse`."""
        return parse(answer_of((yield from self._get(front_path(front_id)))).document)

    def result(self, front_id: str, parse: Parse[AnyFront]) -> Call[AnyFront]:
        """Return the front of a job that has ended, parsed by `parse`.

        Raises:
            Refused: The job failed.
        """
        answer = answer_of((yield from self._get(front_path(front_id))))
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
        return parse(answer_of(response).document)

    def forget(self, front_id: str) -> Call[None]:
        """Delete the front of a job that has ended."""
        yield from self._send(self._delete(front_id))

    def tour(
        self, angle: float | None = None, front: str | None = None, **choice: Unpack[Choice]
    ) -> Call[Tour]:
        """Return a tour of a front by its id, or of the latest, as `Front.choose` does."""
        params = parameters({"angle": angle, **choice}, front)
        return parse_tour(answer_of((yield from self._get("/tour", params))).document)

    def ask(
        self,
        front: str,
        picks: Sequence[int] = (),
        *,
        questions: int = QUESTIONS,
        options: int = OPTIONS,
    ) -> Call[Question]:
        """Return the question about a front by its id that follows some picks, as `Front.ask` does.

        At the end its `document` has the chosen tour or plan.
        """
        given = {"picks": ",".join(map(str, picks)), "questions": questions, "options": options}
        return parse_question(
            answer_of((yield from self._get(f"{front_path(front)}/questions", given)))
        )

    def geojson(
        self, front: str, geometry: Geometry = "straight", plan: int | None = None
    ) -> Call[dict[str, Any]]:
        """Return a front by its id as a FeatureCollection (RFC 7946), if its stops have locations.

        Args:
            front: The front's id.
            geometry: Whether its lines are straight, or follow the streets, which needs a routing
                engine in the service.
            plan: For a fleet, the index of the one plan to draw, from 0; None draws all.
        """
        headers = {"Accept": "application/geo+json"}
        query = {"geometry": geometry} if plan is None else {"geometry": geometry, "plan": plan}
        answer = answer_of((yield from self._get(front_path(front), query, headers)))
        if (kind := answer.read("type", text)) != "FeatureCollection":
            raise unexpected("answer/type", "FeatureCollection", kind)
        return dict(answer.document)

    def read_files(
        self, files: Mapping[str, bytes], columns: Sequence[Mapping[str, str]] = ()
    ) -> Call[PlanOfFiles]:
        """Return the request in files by their names, for `plan_any`; a mapping with its notes.

        `columns` say what columns are taken for, each with `file`, `name` and `taken_for`.
        """
        content = {"files": parts_of(files, columns)}
        request = HttpRequest(method="POST", path="/files", content=content, timeout=self.timeout)
        answer = answer_of((yield from self._send(request)))
        kind, request = answer.read("kind", text), answer.read("request", members)
        answer.read("notes", each(members))
        return PlanOfFiles(f"/{kind}", request.document, answer=answer.document)

    def fronts(self, most: int = PAGE) -> Call[tuple[ListedFront, ...]]:
        """Return what the service lists of your `most` newest fronts, the newest first.

        They are those of your API key or, where the service has no keys, of your address.
        """
        found: list[ListedFront] = []
        after = None
        while len(found) < most:
            more = {} if after is None else {"after": after}
            params = {"limit": min(most - len(found), PAGE), **more}
            response = yield from self._get("/front", params)
            page = answer_of(response).read("fronts", each(parse_listed))
            found += page
            after = next_page(response)
            if not page or after is None:
                break
        return tuple(found[:most])

    def actors(self) -> Call[tuple[Actor, ...]]:
        """Return the actors that the service has loaded."""
        return answer_of((yield from self._get("/actors"))).read("actors", each(value_of(Actor)))

    def events(self, front_id: str) -> JobEvents:
        """Return the events of a job, before the first one is read."""
        return JobEvents(front_id, self.timeout, self.patience)

    def _plan(self, plan: Plan, parse: Parse[AnyFront]) -> Call[AnyFront]:
        return parse(answer_of((yield from self._post(plan, self.timeout + plan.seconds))).document)

    def _submit(
        self, plan: Plan, parse: Parse[AnyFront], webhook: str | None = None
    ) -> Call[Submitted[AnyFront]]:
        headers = {"Prefer": "respond-async", **({"Webhook-Url": webhook} if webhook else {})}
        response = yield from self._post(plan, self.timeout, **headers)
        return answer_of(response).read("id", text), parse

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


def address_of(url: str) -> str:
    """Return a URL with a scheme: that of localhost:8000 is http."""
    return url if "://" in url else f"http://{url}"


def client_headers(api_key: str | None) -> dict[str, str]:
    """Return the headers of every request: the accepted encoding, and the API key if any."""
    return ACCEPTED if api_key is None else {**ACCEPTED, "Authorization": f"Bearer {api_key}"}
