"""Paretour: Pareto fronts of tours under two to four objectives."""


def installed_version() -> str:
    """Return the version of the installed distribution."""
    # Here, since it takes two thirds of the time in which the command line starts.
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("paretour")
    except PackageNotFoundError:
        return "not installed"
