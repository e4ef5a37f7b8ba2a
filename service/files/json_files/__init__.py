"""Read JSON: requests, GeoJSON, and records with columns by name."""
