"""Costs and lines by road, from Valhalla or OSRM, and great-circle distances."""
