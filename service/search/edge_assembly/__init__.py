"""Edge assembly: what is better in one tour put into another (Nagata and Kobayashi, 2013)."""
