/** The guide's search, its list of pages on narrow screens, and the buttons that copy code. */

const MOST_FOUND = 12;
const AROUND = 60; // characters of text shown before what was found

const input = document.querySelector("#search");
const list = document.querySelector("#found");
const count = document.querySelector("#count");
const copied = document.querySelector("#copied");
let sections = null;

/** Return the sections of all pages, fetched at the first use. */
function allSections() {
  sections ??= fetch("search.json").then((answer) => answer.json());
  return sections;
}

/** Return how well a section fits: 0 where a word is missing, more where headings have them. */
function rank(section, words) {
  const heading = `${section.page} ${section.heading}`.toLowerCase();
  const text = section.text.toLowerCase();
  let points = 0;
  for (const word of words) {
    if (section.heading.toLowerCase().includes(word)) points += 10;
    else if (heading.includes(word)) points += 4;
    else if (text.includes(word)) points += 1;
    else return 0;
  }
  return points;
}

/** Return the text round the first of the words. */
function excerpt(text, words) {
  const places = words.map((word) => text.toLowerCase().indexOf(word)).filter((at) => at >= 0);
  const begin = Math.max(0, Math.min(...places, text.length) - AROUND);
  const from = places.length && begin ? text.indexOf(" ", begin) + 1 : 0;
  const shown = text.slice(from, from + 3 * AROUND);
  const cut = from + shown.length < text.length;
  return (from ? "… " : "") + (cut ? `${shown.slice(0, shown.lastIndexOf(" "))} …` : shown);
}

function entry(section, words) {
  const item = document.createElement("li");
  const link = item.appendChild(document.createElement("a"));
  link.href = section.address;
  const title = link.appendChild(document.createElement("strong"));
  title.textContent =
    section.heading === section.page ? section.page : `${section.page}: ${section.heading}`;
  link.appendChild(document.createElement("span")).textContent = excerpt(section.text, words);
  return item;
}

async function search() {
  const words = input.value.toLowerCase().split(/\s+/).filter(Boolean);
  if (!words.length) return close();
  const ranked = (await allSections())
    .map((section) => ({ section, points: rank(section, words) }))
    .filter(({ points }) => points)
    .sort((a, b) => b.points - a.points)
    .slice(0, MOST_FOUND);
  list.replaceChildren(...ranked.map(({ section }) => entry(section, words)));
  if (!ranked.length) {
    list.appendChild(document.createElement("li")).textContent = "No page has all of these words.";
  }
  count.textContent = `${ranked.length} found`;
  list.hidden = false;
}

function close() {
  list.hidden = true;
  count.textContent = "";
}

/** Move the focus among what was found; above the first is the search itself. */
function move(event) {
  const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
  if (!step || list.hidden) return;
  const stops = [input, ...list.querySelectorAll("a")];
  const next = stops[stops.indexOf(document.activeElement) + step];
  if (next) next.focus();
  event.preventDefault();
}

/** Copy a text; where the connection is not safe, browsers have no clipboard, but this command. */
async function copy(text) {
  if (navigator.clipboard) return navigator.clipboard.writeText(text);
  const field = document.createElement("textarea");
  field.className = "unseen";
  field.value = text;
  document.body.append(field);
  field.select();
  const done = document.execCommand("copy");
  field.remove();
  if (!done) throw new Error("the browser does not copy");
}

/** Put a button that copies it over a block of code. */
function addCopyButton(block) {
  const frame = document.createElement("div");
  frame.className = "block";
  block.replaceWith(frame);
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = "Copy";
  let timer;
  button.addEventListener("click", async () => {
    const done = await copy(block.querySelector("code").textContent).then(() => true, () => false);
    button.focus();
    button.textContent = copied.textContent = done ? "Copied" : "Not copied";
    clearTimeout(timer);
    timer = setTimeout(() => {
      button.textContent = "Copy";
      copied.textContent = "";
    }, 1500);
  });
  frame.append(block, button);
}

input.addEventListener("input", search);
input.addEventListener("focus", search);
document.querySelector("search").addEventListener("keydown", move);
document.addEventListener("keydown", (event) => {
  if (event.key === "Escape") close();
  if (event.key === "/" && document.activeElement !== input) {
    event.preventDefault();
    input.focus();
  }
});
document.addEventListener("click", (event) => {
  if (!event.target.closest("search") || event.target.closest("#found a")) close();
});
if (matchMedia("(max-width: 860px)").matches) document.querySelector("#pages").open = false;
document.querySelectorAll("pre").forEach(addCopyButton);
