"""The engine and the store of many machines: records in Redis, workers under Celery.

A replica stores a record and sends its id through Celery. A worker fetches the record, reports its
progress and stores its result. Messages may be lost or come twice: only Redis counts.
"""

from importlib.util import find_spec


def check_cluster() -> None:
    """Raise ValueError when celery or redis is not installed."""
    if missing := [name for name in ("celery", "redis") if find_spec(name) is None]:
        raise ValueError(f"PARETOUR_REDIS_URL needs the extra paretour[cluster]: no {missing[0]}")
