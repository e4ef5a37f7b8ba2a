"""The command `paretour`."""
