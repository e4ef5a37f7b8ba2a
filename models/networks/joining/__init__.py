"""Joining: paths, the costs of edges between them, and what PA-One does with both."""
