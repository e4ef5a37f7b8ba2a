"""Plan in this process, for the command line and for programs that import `paretour`."""
