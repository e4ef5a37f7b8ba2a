"""Three-opt: exchanges of two or three steps, and longer ones made of two, for many cities."""
