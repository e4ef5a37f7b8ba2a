/** A table that can be typed in: a name and the cells of each row, and a button that deletes it. */

import { made } from "../common/elements.js";
import { isOwnName } from "../planning/faults.js";
import { say } from "../planning/status.js";
import { blockOf, cellsOf, filledSaid } from "./filling.js";

const PAGE = 50; // rows that are shown at once, since thousands of inputs are slow
const MOST_REVEALED = 500; // rows

export class EditableTable {
  #element;
  #told;
  #noun;
  #shown = PAGE;
  #columns = [];
  #rows = [];
  #drawn = ""; // which cells are in the document
  #fill = null; // the button that copies a cell down
  #last = null; // the cell that had the focus last, of its column

  /**
   * @param {{ onName: (row: number, text: string) => void, onCells: (cells: { row: number, column: number, text: string }[]) => void,
   *   onDelete: (row: number) => void }} told callbacks for changes by the user
   * @param {string} noun what a row is
   * @param {HTMLButtonElement | null} fill copies the cell that had the focus last into all below it, as Ctrl+D does
   */
  constructor(element, told, noun = "Stop", fill = null) {
    this.#element = element;
    this.#told = told;
    this.#noun = noun;
    element.addEventListener("change", ({ target }) => this.#changed(target));
    element.addEventListener("click", ({ target }) => this.#clicked(target));
    element.addEventListener("paste", (event) => this.#paste(event));
    if (!fill) return;
    this.#fill = fill;
    fill.addEventListener("click", () => this.#copyDown());
    element.addEventListener("focusin", ({ target }) => this.#note(target));
    element.addEventListener("keydown", (event) => {
      if (event.key.toLowerCase() !== "d" || !(event.ctrlKey || event.metaKey) || fill.disabled) return;
      event.preventDefault();
      this.#copyDown();
    });
  }

  /** The cells that a text fills which is pasted into a cell; null if it fills only that, or is a table of its own. */
  blockAt({ dataset: { column } = {} }, text) {
    return isNumbered(column) ? blockOf(text, this.#columns.length - Number(column)) : null;
  }

  #paste(event) {
    const block = this.blockAt(event.target, event.clipboardData.getData("text"));
    if (!block) return;
    event.preventDefault();
    event.stopPropagation();
    const { row, column } = event.target.dataset;
    this.#take(cellsOf(block, Number(row), Number(column), this.#rows.length), Number(row) + block.length - this.#rows.length);
  }

  /** Offers to copy a cell down that has the focus. */
  #note({ dataset: { row, column } }) {
    this.#last = isNumbered(column) ? { row: Number(row), column: Number(column) } : null;
    this.#offer();
  }

  #offer() {
    if (!this.#fill) return;
    const title = this.#last && this.#columns[this.#last.column]?.title;
    this.#fill.disabled = !title || this.#last.row >= this.#rows.length - 1;
    this.#fill.textContent = title ? `Fill down ${title.toLowerCase()}` : "Fill down";
  }

  /** What is typed in the cell, and not read yet, is copied as well. */
  #copyDown() {
    const { row, column } = this.#last;
    const text = this.#element.querySelector(`[data-row="${row}"][data-column="${column}"]`)?.value.trim() ?? this.#rows[row].cells[column] ?? "";
    this.#take(this.#rows.slice(row).map((_, down) => ({ row: row + down, column, text: String(text) })), 0);
  }

  #take(cells, left) {
    for (const { row, column, text } of cells) {
      const input = this.#element.querySelector(`[data-row="${row}"][data-column="${column}"]`);
      if (input) input.value = input.dataset.shown = text;
    }
    this.#told.onCells(cells);
    say(filledSaid(cells.length, Math.max(left, 0)));
  }

  /**
   * Shows rows, each `{ name, cells, unread }` with the text of its cells and the columns of those that
   * are not understood, under columns `{ title, members, list, text }`: the members of a request that the
   * column is about, the id of a list of proposals, and whether its cells are more than numbers; columns of a
   * `group` stand below its name.
   */
  show(columns, rows) {
    this.#columns = columns;
    this.#rows = rows;
    this.#draw();
    this.#offer();
  }

  /** Goes back to the first cell. */
  forget() {
    this.#drawn = "";
    this.#element.scrollTo(0, 0);
  }

  /** Shows the rows up to this one, with the cursor in its name or a cell. */
  focus(row, column = "name") {
    this.#shown = Math.max(this.#shown, row + 1);
    this.#draw();
    this.#element.querySelector(`[data-row="${row}"][data-column="${column}"]`)?.focus();
  }

  /** Scrolls the table to this row, unless it has very many. */
  reveal(row) {
    if (row >= MOST_REVEALED) return;
    this.#shown = Math.max(this.#shown, row + 1);
    this.#draw();
    const line = this.#element.querySelector(`[data-row="${row}"]`).closest("tr");
    this.#element.scrollTop = line.offsetTop + line.offsetHeight - this.#element.clientHeight;
  }

  /** Marks the cells that are not understood. */
  mark() {
    for (const input of this.#element.querySelectorAll("input")) {
      if (this.#isUnread(input)) input.setAttribute("aria-invalid", "true");
    }
  }

  #isUnread({ dataset: { row, column } }) {
    return Boolean(this.#rows[row].unread?.includes(Number(column)));
  }

  /** Keeps the inputs where only their text has changed, so that the cursor stays in its cell. */
  #draw() {
    const rows = this.#rows.slice(0, this.#shown);
    const wanted = JSON.stringify([this.#columns, rows.length, this.#rows.length]);
    if (wanted === this.#drawn) return this.#fillIn();
    this.#drawn = wanted;
    const className = this.#columns[0]?.group ? "grouped" : "";
    const table = made("table", { className }, head(this.#noun, this.#columns), body(this.#columns, rows));
    this.#element.replaceChildren(table);
    const left = this.#rows.length - rows.length;
    if (left > 0) this.#element.append(button("more", `Show ${Math.min(left, PAGE)} more of ${left}`));
    this.#element.hidden = !this.#rows.length;
    this.#fillIn();
  }

  #fillIn() {
    for (const input of this.#element.querySelectorAll("input")) this.#write(input);
    for (const each of this.#element.querySelectorAll(".remove")) {
      each.setAttribute("aria-label", `Delete ${this.#rows[each.dataset.remove].name}`);
    }
  }

  #write(input) {
    const { row, column } = input.dataset;
    const { name, cells } = this.#rows[row];
    const named = column === "name";
    const typed = input === document.activeElement && input.value !== input.dataset.shown;
    if (input.validity.valid && !typed) input.value = input.dataset.shown = named ? name : (cells[column] ?? "");
    input.size = Math.max(input.value.length, 1);
    const label = named ? `Name of ${this.#noun.toLowerCase()} ${Number(row) + 1}` : `${this.#columns[column].title} of ${name}`;
    input.setAttribute("aria-label", label);
  }

  #changed(input) {
    const { row, column } = input.dataset;
    input.dataset.shown = input.value;
    const value = input.value.trim();
    if (column === "name") this.#named(input, Number(row), value);
    else if (column !== undefined) this.#told.onCells([{ row: Number(row), column: Number(column), text: value }]);
  }

  #named(input, row, text) {
    const others = this.#rows.toSpliced(row, 1).map(({ name }) => name);
    if (isOwnName(input, text, others, this.#noun.toLowerCase())) this.#told.onName(row, text);
  }

  #clicked(target) {
    if (target.className === "more") {
      this.#shown += PAGE;
      this.#draw();
    } else if (target.dataset.remove !== undefined) this.#told.onDelete(Number(target.dataset.remove));
  }
}

function head(noun, columns) {
  const cells = [noun, ...columns.map(({ title }) => title)].map((title) => made("th", { scope: "col" }, title));
  return made("thead", {}, ...groups(columns), made("tr", {}, ...cells, made("td")));
}

/** The names of the groups over their columns, if there are any. */
function groups(columns) {
  const names = [...new Set(columns.map(({ group }) => group))].filter(Boolean);
  if (!names.length) return [];
  const cells = names.map((name) => made("th", { scope: "colgroup", colSpan: columns.filter(({ group }) => group === name).length }, name));
  return [made("tr", {}, made("td"), ...cells, made("td"))];
}

function body(columns, rows) {
  const lines = rows.map((_, row) => {
    const cells = [input(row, "name", { members: "id", text: true }), ...columns.map((column, at) => input(row, at, column)), remove(row)];
    return made("tr", {}, ...cells.map((each) => made("td", {}, each)));
  });
  return made("tbody", {}, ...lines);
}

function input(row, column, { members = "", list, text }) {
  const field = made("input", { autocomplete: "off", ...(text ? { className: "text" } : { inputMode: "decimal" }) });
  if (list) field.setAttribute("list", list);
  Object.assign(field.dataset, { row, column, members });
  return field;
}

function remove(row) {
  const each = button("remove", "×");
  each.dataset.remove = row;
  return each;
}

const isNumbered = (column) => /^\d+$/.test(column ?? "");
const button = (className, said) => made("button", { type: "button", className }, said);
