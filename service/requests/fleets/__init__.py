"""The fields of `POST /fleet`, and their checks."""
