"""Join paths to a tour by the costs of the edges between them: the parts of PA-One."""
