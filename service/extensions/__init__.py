"""Constructors of tours and a search of other packages, which an operator names."""
