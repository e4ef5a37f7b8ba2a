"""The actors and critics, and what they are made of."""
