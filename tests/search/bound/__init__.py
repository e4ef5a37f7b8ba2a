"""Tests of `service/search/bound`."""
