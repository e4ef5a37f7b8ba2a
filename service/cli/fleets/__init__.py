"""Fronts of plans in the command: planned for fleets, printed, and drawn."""
