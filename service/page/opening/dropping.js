/** Take files that are dropped anywhere on the page. */

/**
 * Marks an element while something is dragged over the page, and opens the files that are dropped. A
 * browser gives no content of folders, so only the name of the first one is passed on.
 */
export function takeDropped(marked, openFiles, onFolder) {
  for (const kind of ["dragover", "drop"]) addEventListener(kind, (event) => event.preventDefault());
  addEventListener("dragover", () => marked.classList.add("over"));
  addEventListener("dragleave", () => marked.classList.remove("over"));
  addEventListener("drop", ({ dataTransfer: { files, items } }) => {
    marked.classList.remove("over");
    const folder = [...items].map((item) => item.webkitGetAsEntry?.()).find((entry) => entry?.isDirectory);
    if (folder) onFolder(folder.name);
    else openFiles([...files]);
  });
}
