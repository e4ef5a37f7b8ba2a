/** Read a map.yaml of ROS: how to read the picture that it names, and where the map is. */

const REQUIRED = ["image", "resolution", "origin", "occupied_thresh", "free_thresh", "negate"];
const MODES = ["trinary", "scale", "raw"];

/** `{ image, how, place }`: how shades are meant, and `cell_size` and `origin` of the request. */
export function interpretation(name, text) {
  const keys = keysOf(text);
  const missing = REQUIRED.filter((key) => !(key in keys));
  if (missing.length) throw new Error(`${name} must have ${missing.join(", ")}`);
  const mode = (keys.mode ?? "trinary").toLowerCase();
  if (!MODES.includes(mode)) throw new Error(`mode of ${name} must be one of ${MODES.join(", ")}, got ${mode}`);
  const number = (key, value = keys[key]) => numberOf(value, `${key} of ${name}`);
  const how = { mode, negate: Boolean(number("negate", flag(keys.negate))), occupied: number("occupied_thresh"), free: number("free_thresh") };
  if (mode !== "raw" && how.free >= how.occupied) throw new Error(`free_thresh of ${name} must be less than occupied_thresh`);
  const origin = keys.origin.replace(/[[\]]/g, "").split(",").map((value) => number("origin", value));
  if (origin.length !== 3) throw new Error(`origin of ${name} must be x, y and yaw, got ${keys.origin}`);
  return { image: keys.image, how, place: { cell_size: number("resolution"), origin } };
}

/** Keys with one value each on their line; the items of a list may stand below it, after dashes. */
function keysOf(text) {
  const keys = {};
  let last = null;
  for (const line of text.split(/\r?\n/)) {
    const said = line.replace(/(^|\s)#.*$/, "").trim();
    const [, key, value] = /^(\w+)\s*:\s*(.*)$/.exec(said) ?? [];
    const [, item] = /^-\s+(.*)$/.exec(said) ?? [];
    if (key) keys[(last = key)] = unquoted(value);
    else if (item && last) keys[last] += `${keys[last] && ","}${item}`;
  }
  return keys;
}

const unquoted = (value) => value.replace(/^(["'])(.*)\1$/, "$2");
const flag = (value) => ({ true: "1", false: "0" })[value.toLowerCase()] ?? value;

function numberOf(value, what) {
  const number = Number(value);
  if (value.trim() === "" || !Number.isFinite(number)) throw new Error(`${what} must be a number, got ${value.slice(0, 60)}`);
  return number;
}
