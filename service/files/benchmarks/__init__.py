"""Benchmarks of vehicle routing: CVRPLIB and VRPLIB, Solomon, Gehring and Homberger, Li and Lim."""
