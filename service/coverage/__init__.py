"""Maps: from a grid and places on it to an instance, and from tours to paths."""
