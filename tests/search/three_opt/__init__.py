"""Tests of `service/search/three_opt`."""
