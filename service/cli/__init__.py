"""The command `paretour`: a module for each command, its options, and how it prints and plots."""
