"""Plan fleets: fronts of plans for several vehicles."""
