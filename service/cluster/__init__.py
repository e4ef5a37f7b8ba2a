"""The engine on many machines: records in Redis, where every replica and worker finds them.

A replica keeps a record and sends its id through Celery; a worker fetches the work, tells how it
goes, and ends the record. Messages may get lost, or come twice: what counts is in Redis.
"""

from importlib.util import find_spec


def check_cluster() -> None:
    """Nothing, if what this needs is installed.

    Raises:
        ValueError: it is not.
    """
    if missing := [each for each in ("celery", "redis") if find_spec(each) is None]:
        raise ValueError(f"PARETOUR_REDIS_URL needs the extra paretour[cluster]: no {missing[0]}")
