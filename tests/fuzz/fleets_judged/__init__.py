"""Small fleets, and a judge of their plans that shares no code with the service."""
