"""The inside of a worker process of the cluster: one record at a time."""

import os
import signal
import time
import uuid
from collections.abc import Callable
from socket import gethostname
from threading import Event, Thread

from service.cluster.records import Kept
from service.cluster.worker_store import Ledger, Taken
from service.jobs.front_document import Rendered
from service.jobs.messages import Snapshot
from service.jobs.outcomes import ended, failed
from service.jobs.process import MakePlanner
from service.jobs.record import Record
from service.jobs.submission import MOST_ATTEMPTS, Lost, Overdue, Stopped
from service.jobs.worker_pool import GRACE
from service.jobs.worker_process import Planner, Reporter

_EVERY = 0.05  # seconds between two looks at whether the work is still wanted
_PRESENT = 1.0  # seconds between two signs of life

Draining = Callable[[], bool]


class Drained(Exception):
    """The worker ends, and leaves its work to another."""


Reason = type[Stopped | Overdue | Taken | Drained]


class Hand:
    """Plans what records ask for, each within so many seconds."""

    def __init__(
        self, planner: Planner, ledger: Ledger, seconds: float, draining: Draining
    ) -> None:
        self._planner = planner
        self._ledger = ledger
        self._seconds = seconds
        self._draining = draining

    def attend(self) -> None:
        """Get ready, and say from then on that there is a worker."""
        self._planner.warm_up()
        Thread(target=self._be_present, name="present", daemon=True).start()

    def work(self, id: str, known_lost: bool) -> None:  # noqa: A002
        """Do the work of a record, if that is still to do.

        Raises:
            Drained: another worker has to.
        """
        kept = self._ledger.begin(id, known_lost)
        if kept is None:
            return
        if kept.attempts > MOST_ATTEMPTS:
            self._ledger.finish(failed(kept.record, Lost(), kept.record.front))
            return
        watch = _Watch(kept, self._ledger, time.monotonic() + self._seconds, self._draining)
        found = self._found(kept, watch)
        watch.end()
        if watch.why is Drained:
            self._ledger.hand_back(id)
            raise Drained
        if watch.why is not Taken:
            self._ledger.finish(found)

    def _found(self, kept: Kept, watch: "_Watch") -> Record:
        work = kept.record.work
        assert work is not None
        try:
            front = self._planner.plan(work, watch.stop.is_set, Reporter(watch.tell))
        except Exception as error:
            if watch.why is None:
                return failed(kept.record, error, watch.front)
            return watch.ended(watch.front)
        return watch.ended(front)

    def _be_present(self) -> None:
        while True:
            self._ledger.present()
            time.sleep(_PRESENT)


class _Watch:
    """Looks, while work goes on, whether it is still wanted, and ends what does not listen."""

    def __init__(self, kept: Kept, ledger: Ledger, deadline: float, draining: Draining) -> None:
        self.stop = Event()
        self.why: Reason | None = None
        self.front = kept.record.front
        self._kept = kept
        self._ledger = ledger
        self._deadline = deadline
        self._draining = draining
        self._over = Event()
        self._thread = Thread(target=self._look, name="watch", daemon=True)
        self._thread.start()

    def tell(self, snapshot: Snapshot) -> None:
        """Take note of how far the work has come."""
        self.front = snapshot.front
        self._ledger.tell(self._kept.record.id, snapshot)

    def ended(self, front: Rendered) -> Record:
        """The record, which ends now."""
        why = self.why if self.why in (Stopped, Overdue) else None
        return ended(self._kept.record, front, why, time.time() - self._kept.asked)

    def end(self) -> None:
        """The work is over."""
        self._over.set()
        self._thread.join()

    def _look(self) -> None:
        while not self._over.wait(_EVERY):
            self.why = self._reason()
            if self.why is not None:
                self.stop.set()
                if not self._over.wait(GRACE):
                    self._insist()

    def _reason(self) -> Reason | None:
        if time.monotonic() > self._deadline:
            return Overdue
        return Drained if self._draining() else self._ledger.reason(self._kept.record.id)

    def _insist(self) -> None:
        if self.why is Drained:
            self._ledger.hand_back(self._kept.record.id)
        elif self.why is not Taken:
            self._ledger.finish(self.ended(self.front))
        os.kill(os.getpid(), signal.SIGKILL)


def make_hand(
    make_planner: MakePlanner, redis_url: str, seconds: float, draining: Draining
) -> Hand:
    """A hand of this process, with a name that no other has."""
    worker = f"{gethostname()}:{os.getpid()}:{uuid.uuid4().hex}"
    return Hand(make_planner(), Ledger(redis_url, worker), seconds, draining)
