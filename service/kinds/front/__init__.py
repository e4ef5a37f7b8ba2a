"""Fronts of tours through stops or cities: `POST /front`."""
