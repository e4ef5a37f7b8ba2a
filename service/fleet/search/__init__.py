"""Ruin and recreate: the search for the front of a fleet. Compiled."""
