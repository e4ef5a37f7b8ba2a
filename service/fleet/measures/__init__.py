"""Measure plans of fleets, beside the costs of their legs."""
