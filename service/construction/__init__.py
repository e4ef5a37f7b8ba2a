"""Build first tours with a network, within its share of the time limit."""
