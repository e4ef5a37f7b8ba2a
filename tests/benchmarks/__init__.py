"""Figures of the project, each from a command: `python -m tests.benchmarks NAME`."""
