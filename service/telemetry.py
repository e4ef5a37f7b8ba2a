"""Logs as lines of JSON, the server's own among them."""

from typing import Any

_TALKATIVE = ("uvicorn.access", "celery.worker.strategy", "celery.app.trace")


def logging_config(level: str = "INFO") -> dict[str, Any]:
    """For `logging.config.dictConfig`: everything goes to standard error, an object a line."""
    formatter = {
        "()": "pythonjsonlogger.json.JsonFormatter",
        "format": "%(asctime)s %(levelname)s %(name)s %(message)s",
        "rename_fields": {"asctime": "time", "levelname": "level", "name": "logger"},
        "datefmt": "%Y-%m-%dT%H:%M:%S%z",
    }
    return {
        "version": 1,
        "disable_existing_loggers": False,
        "formatters": {"json": formatter},
        "handlers": {"stderr": {"class": "logging.StreamHandler", "formatter": "json"}},
        "root": {"level": level, "handlers": ["stderr"]},
        # A line for each request is written by the service, which knows more of it.
        "loggers": {name: {"level": "WARNING"} for name in _TALKATIVE},
    }
