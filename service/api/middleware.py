"""Middleware: security headers, request ids, the log, problem documents, deadlines of bodies."""

import asyncio
import logging
import re
import time
import uuid
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from http import HTTPStatus

from starlette.datastructures import Headers
from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.api.responses import problem_response
from service.errors import Refusal, ShuttingDown

RawHeaders = list[tuple[bytes, bytes]]  # with names in lower case
# The page loads only files of the service, and draws maps of robots into images (data:).
_CONTENT_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src {images}; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_IMAGES = "'self' data:"
_SECURITY_HEADERS = {
    "Cross-Origin-Opener-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}


def _set_headers(start: Message, headers: RawHeaders) -> None:
    """Set headers of an answer that begins, and replace any with the same names."""
    names = [name for name, _ in headers]
    others = [each for each in start.get("headers", ()) if each[0] not in names]
    start["headers"] = [*others, *headers]


class _Middleware:
    """The base of middleware for requests; the start and end of the application pass unchanged."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on one request."""
        await (self._pass_on if scope["type"] == "http" else self._app)(scope, receive, send)

    async def _pass_on(self, scope: Scope, receive: Receive, send: Send) -> None:
        raise NotImplementedError


class SecurityHeadersMiddleware(_Middleware):
    """Tells browsers to load only files of the service, and to embed the page nowhere.

    Args:
        images: Another source of images, by default none.
    """

    def __init__(self, app: ASGIApp, images: str = "") -> None:
        super().__init__(app)
        policy = _CONTENT_POLICY.format(images=f"{_IMAGES} {images}".strip())
        headers = {"Content-Security-Policy": policy, **_SECURITY_HEADERS}
        self._headers = Headers(headers).raw

    async def _pass_on(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                _set_headers(message, self._headers)
            await send(message)

        await self._app(scope, receive, send_with_headers)


ANONYMOUS = "anonymous"
ANSWER_HEADERS = "answer_headers"  # in a request's scope: what is known before there is an answer
UNMATCHED = "unmatched"
_SAFE_ID = re.compile(r"[A-Za-z0-9._-]{1,64}")
# Only in the log and the metrics, as in nginx: the client went away before its body had ended.
_CLIENT_CLOSED_REQUEST = 499


@dataclass(frozen=True, kw_only=True)
class AnsweredRequest:
    """A request and its answer, for the log and the metrics.

    `path` is the template that the request matched, such as /front/{id}. `seconds` is the time
    until the end of the answer.
    """

    request_id: str
    caller: str
    method: str
    path: str
    status: int
    seconds: float


Observer = Callable[[AnsweredRequest], None]
_LOG = logging.getLogger("paretour")
_REQUESTS = logging.getLogger("paretour.requests")


class RequestMiddleware(_Middleware):
    """Gives each request an id, and reports it to observers once it is answered.

    The caller's own X-Request-ID is taken where it is short and plain enough to log. Until the
    caller is authenticated, it is anonymous. An unhandled exception is answered with a problem
    document.

    Args:
        observers: What requests are reported to, such as the log and the metrics.
    """

    def __init__(self, app: ASGIApp, observers: Iterable[Observer]) -> None:
        super().__init__(app)
        self._observers = tuple(observers)

    async def _pass_on(self, scope: Scope, receive: Receive, send: Send) -> None:
        began = time.perf_counter()
        own_id = Headers(scope=scope).get("x-request-id", "")
        request_id = own_id if _SAFE_ID.fullmatch(own_id) else uuid.uuid4().hex
        scope["request_id"] = request_id
        scope["caller"] = ANONYMOUS
        scope[ANSWER_HEADERS] = []
        status = None  # until an answer begins

        async def send_with_id(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                own = (b"x-request-id", request_id.encode())
                _set_headers(message, [own, *scope[ANSWER_HEADERS]])
            await send(message)

        try:
            await self._app(scope, receive, send_with_id)
        except ClientDisconnect:
            status = _CLIENT_CLOSED_REQUEST  # there is nobody left to answer
        except (Exception, asyncio.CancelledError) as error:
            refusal = _refusal_of(error, request_id)
            if status is None:
                response = problem_response(refusal, scope)
                await response(scope, receive, send_with_id)
            elif isinstance(error, Exception):
                raise
        finally:
            answered = AnsweredRequest(
                request_id=request_id,
                caller=scope["caller"],
                method=scope["method"],
                path=getattr(scope.get("route"), "path", UNMATCHED),
                status=status or HTTPStatus.INTERNAL_SERVER_ERROR,
                seconds=time.perf_counter() - began,
            )
            for observer in self._observers:
                observer(answered)


def _refusal_of(error: BaseException, request_id: str) -> Refusal:
    if isinstance(error, asyncio.CancelledError):  # only a server that shuts down cancels
        return ShuttingDown()
    _LOG.exception("request %s failed", request_id)
    return Refusal("internal-error")


def log_request(answered: AnsweredRequest) -> None:
    """Write one line to the log for a request."""
    _REQUESTS.info("request", extra=vars(answered))


class ProblemMiddleware(_Middleware):
    """Turns the framework's errors in plain text into problem documents.

    These are refused preflights (CORS), and ranges outside a file.
    """

    async def _pass_on(self, scope: Scope, receive: Receive, send: Send) -> None:
        start: Message | None = None
        text = b""

        async def send_problem(message: Message) -> None:
            nonlocal start, text
            if message["type"] == "http.response.start" and _is_plain_error(message):
                start = message
                return
            if start is None:
                await send(message)
                return
            text += message.get("body", b"")
            if not message.get("more_body", False):
                refusal = _framework_refusal(scope["method"], start, text.decode(errors="replace"))
                response = problem_response(refusal, scope)
                await response(scope, receive, send)

        await self._app(scope, receive, send_problem)


def _is_plain_error(message: Message) -> bool:
    if message["status"] < HTTPStatus.BAD_REQUEST:
        return False
    # Problem documents, and errors of the protocol of agents, are JSON already.
    return not Headers(raw=message["headers"]).get("content-type", "").endswith("json")


def _framework_refusal(method: str, start: Message, text: str) -> Refusal:
    """Return a refusal with the framework's sentence and headers."""
    status = start["status"]
    if method == "OPTIONS":
        refusal = Refusal("preflight-refused", reason=text)
    elif status == HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE:
        refusal = Refusal("unsatisfiable-range")
    else:
        refusal = Refusal("refused", detail=text or HTTPStatus(status).phrase)
    refusal.status = status
    of_the_text = ("content-type", "content-length")
    headers = Headers(raw=start["headers"]).items()
    refusal.headers = {name: value for name, value in headers if name not in of_the_text}
    return refusal


class BodyTimeoutMiddleware(_Middleware):
    """Refuses a body whose last byte comes too late, measured from the start of the request."""

    def __init__(self, app: ASGIApp, seconds: float) -> None:
        super().__init__(app)
        self._seconds = seconds

    async def _pass_on(self, scope: Scope, receive: Receive, send: Send) -> None:
        deadline = asyncio.get_running_loop().time() + self._seconds
        whole = False

        async def receive_in_time() -> Message:
            nonlocal whole
            if whole:  # the one message that may follow, that the client has gone, has no deadline
                return await receive()
            try:
                async with asyncio.timeout_at(deadline):
                    message = await receive()
            except TimeoutError:
                headers = {"Connection": "close"}
                raise Refusal("body-too-slow", limit=self._seconds, headers=headers) from None
            whole = not message.get("more_body", False)
            return message

        await self._app(scope, receive_in_time, send)
