"""Bounds: how much hypervolume no front of an instance exceeds, and what that is computed from."""
