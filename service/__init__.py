"""Paretour: Pareto fronts of tours under two objectives."""
