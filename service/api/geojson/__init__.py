"""Answers in GeoJSON (RFC 7946): fronts and tours as lines, stops as points."""
