"""Tests of `service/search/edge_assembly`."""
