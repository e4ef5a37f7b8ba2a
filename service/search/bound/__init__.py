"""Bounds: a hypervolume that no front of the instance exceeds."""
