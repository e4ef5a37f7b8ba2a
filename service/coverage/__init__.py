"""Coverage planning: from places on an occupancy grid to an instance, and from tours to paths."""
