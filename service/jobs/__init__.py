"""Planning tasks in worker processes, and keeping their fronts."""
