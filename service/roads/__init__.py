"""Distances on the earth between stops: great circles, and the matrices of a routing engine."""
