/** Times by their unit, how long something takes in words, and times of the day, such as 10:30, or 10:30:15 where there are seconds. */

export const SECONDS = new Map(Object.entries({ s: 1, second: 1, seconds: 1, min: 60, minute: 60, minutes: 60, h: 3600, hour: 3600, hours: 3600 }));
const [MINUTE, HOUR, DAY, EXACT] = [60, 3600, 86400, 600]; // seconds; below the last one, seconds are said too
const MOST_HOURS = 1000;
const TIME = /^(\d{1,3}):([0-5]\d)(?::([0-5]\d))?$/;
const HOURS = /^(\d\d?)(?: ?[.,:h]? ?([0-5]\d))? ?(?:h|uhr|([ap])\.?m\.?)?$/i; // 8, 8.30, 0830, 8h30, 8:30 Uhr, 8 am

/** How long this is, such as "45 s", "2 min 30 s", "12 min" or "1 h 5 min"; with `exact` also "12 min 5 s". */
export function duration(seconds, { exact = false } = {}) {
  const whole = Math.round(seconds);
  if (!whole) return "0 min";
  if (whole < MINUTE) return `${whole} s`;
  if (whole < (exact ? HOUR : EXACT)) return parts(Math.floor(whole / MINUTE), "min", whole % MINUTE, "s");
  const minutes = Math.round(whole / MINUTE);
  return whole < HOUR ? `${minutes} min` : parts(Math.floor(minutes / MINUTE), "h", minutes % MINUTE, "min");
}

/** The same for the ticks of an axis that are a step apart, such as "45 min", "1:30 h" or "7:30 min". */
export function durationOnAxis(seconds, step) {
  const whole = Math.round(Math.abs(seconds));
  const sign = seconds < 0 && whole ? "−" : "";
  if (step < MINUTE && whole < MINUTE) return `${sign}${step < 1 ? Math.abs(seconds) : whole} s`;
  const minutes = step < MINUTE ? Math.floor(whole / MINUTE) : Math.round(whole / MINUTE);
  const said = minutes < MINUTE ? `${minutes}` : `${Math.floor(minutes / MINUTE)}:${two(minutes % MINUTE)}`;
  return `${sign}${said}${step < MINUTE ? `:${two(whole % MINUTE)}` : ""} ${minutes < MINUTE ? "min" : "h"}`;
}

const two = (value) => String(value).padStart(2, "0");
const parts = (large, unit, small, smaller) => `${large} ${unit}${small ? ` ${small} ${smaller}` : ""}`;

/** The seconds of a time, as 8:30, 8.30, 0830, 8 or 8 am; undefined if a text is none. */
export function timeOfDay(text) {
  const [whole, hours, minutes, seconds = 0] = TIME.exec(text.trim()) ?? [];
  return whole ? HOUR * hours + MINUTE * minutes + Number(seconds) : hoursOfDay(text.trim());
}

function hoursOfDay(text) {
  const [whole, hours, minutes = 0, half] = HOURS.exec(text) ?? [];
  const seconds = HOUR * (half ? (hours % 12) + (/p/i.test(half) ? 12 : 0) : hours) + MINUTE * minutes;
  return whole && seconds <= DAY && !(half && hours > 12) ? seconds : undefined;
}

/** Seconds as a time; undefined if they are not whole, negative, or very many. */
export function timeText(seconds) {
  if (!Number.isInteger(seconds) || seconds < 0 || seconds >= MOST_HOURS * HOUR) return undefined;
  const minutes = `${Math.floor(seconds / HOUR)}:${two(Math.floor(seconds / MINUTE) % MINUTE)}`;
  return seconds % MINUTE ? `${minutes}:${two(seconds % MINUTE)}` : minutes;
}
