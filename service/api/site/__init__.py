"""The sites for browsers: the page, the HTTP reference and the guide."""
