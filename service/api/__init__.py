"""The HTTP interface: what requests may say, and what is answered."""
