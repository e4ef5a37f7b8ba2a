"""Test the tools of agents, called by the client of the protocol's own SDK."""
