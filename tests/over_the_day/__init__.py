"""Tests of `service/over_the_day`."""
