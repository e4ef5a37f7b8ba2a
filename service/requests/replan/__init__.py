"""`POST /front/{id}/replan`: from a stored Task and what has changed to a new Task."""
