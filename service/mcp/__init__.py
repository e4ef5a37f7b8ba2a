"""Let agents plan: the tools of the Model Context Protocol (MCP), over stdio and over HTTP.

A tool calls a service by the Python client: one at a URL, or the application in this process. The
tools plan and read; they change nothing elsewhere.
"""

from importlib.util import find_spec


def check_mcp() -> None:
    """Raise ValueError if the package mcp is not installed."""
    if find_spec("mcp") is None:
        raise ValueError("agents need the extra paretour[mcp]: the package mcp is not installed")
