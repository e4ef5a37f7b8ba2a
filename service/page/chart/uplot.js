/** Load uPlot by its smallest file, which is a script that sets a global rather than a module. */

const src = new URL("../vendor/uplot/uPlot.iife.min.js", import.meta.url).href;
const script = Object.assign(document.createElement("script"), { src });
await new Promise((loaded, failed) => {
  script.addEventListener("load", loaded);
  script.addEventListener("error", () => failed(new Error(`${src} was not loaded`)));
  document.head.append(script);
});

export default globalThis.uPlot;
