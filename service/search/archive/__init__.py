"""The archive: all nondominated tours that a search has found so far."""
