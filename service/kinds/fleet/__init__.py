"""Fronts of plans for several vehicles: `POST /fleet`."""
