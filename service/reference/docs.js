/** The HTTP reference, drawn by Swagger UI from the service's own OpenAPI document. */

globalThis.SwaggerUIBundle({
  url: "openapi.json",
  dom_id: "#reference",
  deepLinking: true,
  defaultModelsExpandDepth: 0,
});
