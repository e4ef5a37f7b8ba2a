"""Rates: how many requests a caller may make in a time, counted in memory or in Redis."""
