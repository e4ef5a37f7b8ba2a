"""Other ways to a front, on the same instances, reference point and clock."""
