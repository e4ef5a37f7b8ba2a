"""Notes on requests: what is allowed, and yet is likely to be a mistake."""
