"""Networks: the actors, their layers, the critic."""
