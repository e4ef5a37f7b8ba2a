/** Read the map of the world: coasts, lakes, borders and towns, as `python -m tests.helpers.world` writes them. */

const STEP = 1 / 1000; // degrees

/**
 * @param {ArrayBuffer} buffer the file
 * @returns {{ land: number[][][], lakes: number[][][], borders: number[][][], towns: { name: string, at: number[] }[] }}
 *   lines of pairs of longitude and latitude, and towns, the largest first
 */
export function readWorld(buffer) {
  const bytes = new Uint8Array(buffer);
  let at = 0;
  const next = () => {
    let [value, unit] = [0, 1];
    for (; bytes[at] > 127; unit *= 128) value += unit * (bytes[at++] & 127);
    value += unit * bytes[at++];
    return value % 2 ? -(value + 1) / 2 : value / 2;
  };
  const many = (make) => Array.from({ length: next() }, make);
  const steps = (from) => () => {
    for (const axis of [0, 1]) from[axis] += next();
    return from.map((step) => step * STEP);
  };
  const lines = () => {
    const from = [0, 0];
    return many(() => many(steps(from)));
  };
  const [land, lakes, borders] = [lines(), lines(), lines()];
  const place = steps([0, 0]);
  const words = new TextDecoder();
  const towns = many(() => {
    const where = place();
    const length = next();
    return { name: words.decode(bytes.subarray(at, (at += length))), at: where };
  });
  return { land, lakes, borders, towns };
}
