"""First plans of a fleet without a search: the tours of a network, cut into routes."""
