"""What plans of fleets are measured by, beside the costs of their legs."""
