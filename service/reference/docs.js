/** The HTTP reference, drawn by Swagger UI from the service's own OpenAPI document. */

const dark = matchMedia("(prefers-color-scheme: dark)");
const follow = () => document.documentElement.classList.toggle("dark-mode", dark.matches);

/** Paths stand in buttons, which may hold no links: the address follows the operation that is open. */
const PathsAsText = () => ({
  wrapComponents: { DeepLink: (_, { React }) => ({ text }) => React.createElement("span", null, text) },
});

/** Where everybody may call, nothing asks for a key. */
async function hideKeys() {
  const { status } = await fetch("actors");
  document.documentElement.classList.toggle("without-keys", status !== 401);
}

hideKeys();
follow();
dark.addEventListener("change", follow);
globalThis.SwaggerUIBundle({
  url: "openapi.json",
  dom_id: "#reference",
  deepLinking: true,
  defaultModelsExpandDepth: 0,
  plugins: [PathsAsText],
});
