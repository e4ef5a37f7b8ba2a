"""Edge assembly: improve a tour by parts of another (Nagata and Kobayashi, 2013)."""
