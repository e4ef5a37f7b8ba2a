/** Make elements of HTML and SVG. */

/** An element with these members, and these parts in it. */
export function made(tag, members = {}, ...parts) {
  const element = Object.assign(document.createElement(tag), members);
  element.append(...parts);
  return element;
}

/** An item of a numbered list of stops: the name of a stop, and when it is reached if that is known. */
export const visitItem = (name, hour) => made("li", {}, name, ...(hour ? [" ", made("time", { textContent: hour })] : []));

export function svgElement(tag, attributes = {}, text = "") {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.textContent = text;
  return element;
}
