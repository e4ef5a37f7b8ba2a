"""Construct tours without a network, as starts of descents."""
