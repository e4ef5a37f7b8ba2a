"""Plan tours whose costs change with the time of day."""
