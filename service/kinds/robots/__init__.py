"""Fronts of plans for several robots on a map: `POST /coverage` with `robots`."""
