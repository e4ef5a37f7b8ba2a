"""Requests of `POST /front/{id}/replan`: from what changed to the rest of the way."""
