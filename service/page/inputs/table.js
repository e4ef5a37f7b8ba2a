/** A table of stops that can be typed in: a name and the numbers of each, and a button that deletes it. */

const PAGE = 50; // rows that are shown at once, since thousands of inputs are slow

export class StopsTable {
  #element;
  #told;
  #shown = PAGE;
  #columns = [];
  #rows = [];

  /**
   * @param {{ onName: (row: number, text: string) => void, onNumber: (row: number, column: number,
   *   text: string) => void, onDelete: (row: number) => void }} told callbacks for changes by the user
   */
  constructor(element, told) {
    this.#element = element;
    this.#told = told;
    element.addEventListener("change", ({ target }) => this.#changed(target));
    element.addEventListener("click", ({ target }) => this.#clicked(target));
  }

  /** Shows stops, each `{ name, numbers }`, under the titles of their numbers. */
  show(columns, rows) {
    this.#columns = columns;
    this.#rows = rows;
    this.#draw();
  }

  /** Shows the rows up to this one, and puts the cursor into its name. */
  focus(row) {
    this.#shown = Math.max(this.#shown, row + 1);
    this.#draw();
    this.#element.querySelector(`[data-row="${row}"]`)?.focus();
  }

  #draw() {
    const rows = this.#rows.slice(0, this.#shown);
    const table = document.createElement("table");
    table.append(head(this.#columns), body(this.#columns, rows));
    this.#element.replaceChildren(table);
    const left = this.#rows.length - rows.length;
    if (left > 0) this.#element.append(button("more", `Show ${Math.min(left, PAGE)} more of ${left}`));
    this.#element.hidden = !this.#rows.length;
  }

  #changed({ dataset: { row, column }, value }) {
    if (column === "name") this.#told.onName(Number(row), value.trim());
    else if (column !== undefined) this.#told.onNumber(Number(row), Number(column), value.trim());
  }

  #clicked(target) {
    if (target.className === "more") {
      this.#shown += PAGE;
      this.#draw();
    } else if (target.dataset.remove !== undefined) this.#told.onDelete(Number(target.dataset.remove));
  }
}

function head(columns) {
  const row = document.createElement("tr");
  const cells = ["Stop", ...columns].map((title) =>
    Object.assign(document.createElement("th"), { scope: "col", textContent: title }),
  );
  row.append(...cells, document.createElement("td"));
  const made = document.createElement("thead");
  made.append(row);
  return made;
}

function body(columns, rows) {
  const made = document.createElement("tbody");
  made.append(
    ...rows.map(({ name, numbers }, row) => {
      const line = document.createElement("tr");
      line.append(
        cell(input(row, "name", name, `Name of stop ${row + 1}`)),
        ...columns.map((title, column) => cell(input(row, column, numbers[column] ?? "", `${title} of ${name}`))),
        cell(remove(row, name)),
      );
      return line;
    }),
  );
  return made;
}

function cell(content) {
  const made = document.createElement("td");
  made.append(content);
  return made;
}

function input(row, column, value, label) {
  const made = Object.assign(document.createElement("input"), { value, autocomplete: "off" });
  if (column !== "name") made.inputMode = "decimal";
  Object.assign(made.dataset, { row, column });
  made.setAttribute("aria-label", label);
  return made;
}

function remove(row, name) {
  const made = button("remove", "×");
  made.dataset.remove = row;
  made.setAttribute("aria-label", `Delete ${name}`);
  return made;
}

const button = (className, textContent) =>
  Object.assign(document.createElement("button"), { type: "button", className, textContent });
