"""The compiled code that requests need: compiled once, and loaded by later processes."""

from numba import config
from numba.core.event import Event, Listener, install_listener

from service.coverage import shortest_paths
from service.jobs.fleets import fleet_run
from service.replanning import earlier_tours
from service.search import improve


def warm_up() -> None:
    """Compile everything that is compiled, or load it from the cache, unless it is there."""
    improve.warm_up()
    earlier_tours.warm_up()
    shortest_paths.warm_up()
    fleet_run.warm_up()


def load_from_cache() -> None:
    """Do as `warm_up` does, until something would have to be compiled, which takes long."""
    if config.DISABLE_JIT:  # type: ignore[attr-defined]  # set from the environment
        return
    try:
        with install_listener("numba:compile", _RefuseCompilation()):
            warm_up()
    except _NotCached:
        return


class _NotCached(Exception):
    pass


class _RefuseCompilation(Listener):
    def on_start(self, event: Event) -> None:  # noqa: ARG002  # numba's interface
        raise _NotCached

    def on_end(self, event: Event) -> None:
        """Do nothing: nothing was begun."""
