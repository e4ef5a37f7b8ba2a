"""Paretour: Pareto fronts of tours under two objectives."""

from importlib.metadata import PackageNotFoundError, version


def installed_version() -> str:
    """Return the version of the installed distribution."""
    try:
        return version("paretour")
    except PackageNotFoundError:
        return "not installed"
