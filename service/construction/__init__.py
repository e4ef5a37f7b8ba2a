"""First tours, which a network builds within its share of the time limit."""
