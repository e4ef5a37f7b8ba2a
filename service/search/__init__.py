"""Local search for the whole front of an instance, as compiled code."""
