"""Training of actors: networks that build tours of instances for preferences."""
