"""Constructed tours, from which descents set out where nothing better is known."""
