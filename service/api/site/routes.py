"""Routes of files, which the log and the metrics name by their paths, as those of the API."""

from starlette.routing import Match, Route
from starlette.types import Scope


class NamedRoute(Route):
    """A route that tells its path to the log and the metrics."""

    def matches(self, scope: Scope) -> tuple[Match, Scope]:
        """Return whether the route answers a request, and what is new in its scope."""
        match, found = super().matches(scope)
        return match, {**found, "route": self} if match is not Match.NONE else found
