"""Costs that change with the time of day, and how legs are driven under them."""
