"""Requests of `POST /fleet`: several vehicles, and a front of their plans."""
