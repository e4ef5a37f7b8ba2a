"""The units of times and lengths that are known, and how large they are."""

MINUTE, HOUR, DAY = 60, 3600, 86400
_TIMES = {"s": 1, "second": 1, "seconds": 1, "min": MINUTE, "minute": MINUTE, "minutes": MINUTE}
SECONDS = {**_TIMES, "h": HOUR, "hour": HOUR, "hours": HOUR}  # in each unit of time
METRES = {"m": 1, "km": 1000}  # in each unit of length
