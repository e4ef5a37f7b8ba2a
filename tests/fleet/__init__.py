"""Tests of `service/fleet`."""
