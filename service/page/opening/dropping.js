/** Take files that are dropped anywhere on the page. */

/** Marks an element while something is held over the page, and opens the files that are let go. */
export function takeDropped(marked, openFiles) {
  for (const kind of ["dragover", "drop"]) addEventListener(kind, (event) => event.preventDefault());
  addEventListener("dragover", () => marked.classList.add("over"));
  addEventListener("dragleave", () => marked.classList.remove("over"));
  addEventListener("drop", (event) => {
    marked.classList.remove("over");
    openFiles([...event.dataTransfer.files]);
  });
}
