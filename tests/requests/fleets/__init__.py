"""Tests of `service/requests/fleets`."""
