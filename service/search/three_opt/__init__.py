"""Three-opt: exchanges of two or three legs, and longer ones made of these.

For many cities, and for any number where costs differ by direction.
"""
