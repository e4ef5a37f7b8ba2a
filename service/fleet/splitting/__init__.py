"""First plans of a fleet: a network's tours, cut into routes without any search."""
