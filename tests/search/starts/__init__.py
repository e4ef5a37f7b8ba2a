"""Tests of `service/search/starts`."""
