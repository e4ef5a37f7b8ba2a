"""Take a client's address, and the path under which it sees the service, from trusted proxies."""

from starlette.datastructures import Headers
from starlette.types import Scope
from uvicorn._types import ASGIReceiveCallable, ASGISendCallable
from uvicorn._types import Scope as AnyScope
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

from service.api.transport.root_path import is_root_path

HIDDEN = "hidden_client"  # in a request's scope: whether a proxy that is not trusted passed it on
_PASSED_ON = ("x-forwarded-for", "forwarded")


class TrustedProxies(ProxyHeadersMiddleware):
    """Believes X-Forwarded-For, -Proto and -Prefix of trusted proxies alone.

    A request that another proxy passed on is marked: its address is not that of the client.
    X-Forwarded-Prefix is what the proxy has taken away from the path. What is not such a path, or
    comes twice, is ignored, as it is in the other two headers.
    """

    async def __call__(
        self, scope: AnyScope, receive: ASGIReceiveCallable, send: ASGISendCallable
    ) -> None:
        """Pass on one request as its client sent it to the proxy."""
        if scope["type"] == "http":
            peer = scope["client"]
            if (peer[0] if peer else None) in self.trusted_hosts:
                _set_root_path(scope)  # type: ignore[arg-type]  # Starlette's is any mapping
            else:
                sent = {name.decode("latin-1") for name, _ in scope["headers"]}
                scope[HIDDEN] = not sent.isdisjoint(_PASSED_ON)  # type: ignore[literal-required]
        await super().__call__(scope, receive, send)


def _set_root_path(scope: Scope) -> None:
    """Set the root path of a request to its X-Forwarded-Prefix, in place of the setting."""
    prefixes = Headers(scope=scope).getlist("x-forwarded-prefix")
    root_path = prefixes[0].removesuffix("/") if len(prefixes) == 1 else None
    if root_path is None or not is_root_path(root_path):
        return
    former = scope["root_path"]
    scope["root_path"] = root_path
    scope["path"] = root_path + scope["path"].removeprefix(former)
    scope["raw_path"] = root_path.encode() + scope["raw_path"].removeprefix(former.encode())
