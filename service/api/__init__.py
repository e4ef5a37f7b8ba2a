"""The HTTP side of the service: routes, middleware, authentication, metrics and OpenAPI."""
