"""Fronts of a robot's tours over a map: `POST /coverage`."""
