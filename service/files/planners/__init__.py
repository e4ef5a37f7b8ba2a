"""The JSON of other planners: VROOM is read, and the others are refused by name."""
