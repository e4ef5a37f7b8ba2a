"""Requests of `POST /front/{id}/replan`: turn the changes into a task for the rest of the way."""
