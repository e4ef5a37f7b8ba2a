/** The settings of a request: what each is called, and what is wrong with it. */

const FIELDS = [
  { name: "time_limit", label: "Seconds of search", value: "3" },
  { name: "size", label: "Tours", value: "100" },
  { name: "preferences", label: "Directions of the network", value: "100", more: true },
  { name: "start", label: "Start city", value: "0", more: true },
  { name: "seed", label: "Seed", value: "0", more: true },
];

export class Fields {
  #form;

  constructor(form, shown, more) {
    this.#form = form;
    for (const field of FIELDS) (field.more ? more : shown).append(made(field));
  }

  /** The members that are filled in. What is no number stays as it is, for the service to name. */
  get members() {
    const given = FIELDS.map(({ name }) => [name, this.#form[name].value.trim()]);
    return Object.fromEntries(
      given.filter(([, text]) => text).map(([name, text]) => [name, numberOr(text)]),
    );
  }

  /** Takes the settings that a request names, and gives back its other members. */
  take(request) {
    const rest = { ...request };
    for (const { name } of FIELDS) {
      if (typeof request[name] !== "number") continue;
      this.#form[name].value = request[name];
      delete rest[name];
    }
    return rest;
  }
}

function numberOr(text) {
  const number = Number(text);
  return Number.isNaN(number) ? text : number;
}

function made({ name, label, value }) {
  const field = document.createElement("div");
  field.className = "field";
  const caption = Object.assign(document.createElement("label"), { htmlFor: name, textContent: label });
  const input = Object.assign(document.createElement("input"), { id: name, name, value });
  input.inputMode = "decimal";
  input.autocomplete = "off";
  input.setAttribute("aria-describedby", `${name}-fault`);
  const fault = Object.assign(document.createElement("p"), { id: `${name}-fault`, className: "fault" });
  fault.setAttribute("role", "alert");
  field.append(caption, input, fault);
  return field;
}
