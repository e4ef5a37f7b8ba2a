"""The factory: networks that map cities and preferences to tours, and their training."""
