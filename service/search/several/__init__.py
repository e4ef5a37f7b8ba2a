"""The search for fronts of three and four objectives, by the kernels of the search for two."""
