"""The one reader of files that people have, as members of a request and notes on it."""
