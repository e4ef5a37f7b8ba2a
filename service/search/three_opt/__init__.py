"""Three-opt: exchanges of two or three steps, found one after another, for large instances."""
