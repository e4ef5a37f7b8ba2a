"""Fleets: plans for several vehicles, and the front of them under two objectives."""
