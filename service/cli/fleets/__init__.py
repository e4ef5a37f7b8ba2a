"""The commands for fleets and robots: plan, print and plot fronts of plans."""
