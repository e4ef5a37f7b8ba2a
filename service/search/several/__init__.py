"""The schedule for three and four objectives, their volumes, and the choice of their tours."""
