"""Training data: instances, preferences, and tours to imitate."""
