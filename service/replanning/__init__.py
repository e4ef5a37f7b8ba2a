"""Replanning: the rest of a front's tours, when things have changed on the way."""
