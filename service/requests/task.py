"""What is to be planned: all that was asked, read and checked."""

from dataclasses import dataclass

from service.coverage.survey import Coverage
from service.instance import Instance
from service.planner import Demand


@dataclass(frozen=True, eq=False, kw_only=True)
class Task:
    """Cities, or places on a map, what is asked of their front, and the actor that begins it.

    Over a map, each tour may come with its path.
    """

    subject: Instance | Coverage
    demand: Demand
    actor: str
    paths: bool = False

    @property
    def needs_compiled_code(self) -> bool:
        """Whether more than the network is asked for."""
        return isinstance(self.subject, Coverage) or self.demand.needs_compiled_code
