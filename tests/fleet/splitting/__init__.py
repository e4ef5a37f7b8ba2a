"""Tests of `service/fleet/splitting`."""
