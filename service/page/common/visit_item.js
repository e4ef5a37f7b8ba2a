/** Make an item of a numbered list of stops: the name of a stop, and when it is reached if that is known. */

export function visitItem(name, hour) {
  const item = Object.assign(document.createElement("li"), { textContent: name });
  if (hour) item.append(" ", Object.assign(document.createElement("time"), { textContent: hour }));
  return item;
}
