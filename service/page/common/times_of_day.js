/** Times of the day as text, such as 10:30, or 10:30:15 where there are seconds. */

const [MINUTE, HOUR, MOST_HOURS] = [60, 3600, 1000]; // seconds, seconds, hours
const TIME = /^(\d{1,3}):([0-5]\d)(?::([0-5]\d))?$/;

/** The seconds of a time; undefined if a text is none. */
export function timeOfDay(text) {
  const [whole, hours, minutes, seconds = 0] = TIME.exec(text.trim()) ?? [];
  return whole && HOUR * hours + MINUTE * minutes + Number(seconds);
}

/** Seconds as a time; undefined if they are not whole, negative, or very many. */
export function timeText(seconds) {
  if (!Number.isInteger(seconds) || seconds < 0 || seconds >= MOST_HOURS * HOUR) return undefined;
  const two = (part) => String(part).padStart(2, "0");
  const minutes = `${Math.floor(seconds / HOUR)}:${two(Math.floor(seconds / MINUTE) % MINUTE)}`;
  return seconds % MINUTE ? `${minutes}:${two(seconds % MINUTE)}` : minutes;
}
