"""The files that the command reads, as members of a request."""
