"""Tests of `service/construction`."""
