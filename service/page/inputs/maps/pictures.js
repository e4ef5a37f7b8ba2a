/** Read the pixels of a map's picture: of a PGM file here, of any other by the browser. */

const PGM = /^P[25](?:\s|#[^\n]*\n)+(\d+)(?:\s|#[^\n]*\n)+(\d+)(?:\s|#[^\n]*\n)+(\d+)\s/;
const LONGEST_HEADER = 4096; // bytes, with its comments
const WHITE = 255;

/** `{ width, height, pixel }`, where `pixel` gives red, green, blue and alpha of one, row by row from the top. */
export async function pictureOf(file) {
  const bytes = new Uint8Array(await file.arrayBuffer());
  return /^P[25]/.test(ascii(bytes.subarray(0, 2))) ? pgm(file.name, bytes) : decoded(file);
}

async function decoded(file) {
  let picture;
  try {
    picture = await createImageBitmap(file);
  } catch {
    throw new Error(`${file.name} must be a picture, and is not`);
  }
  const { width, height } = picture;
  const context = new OffscreenCanvas(width, height).getContext("2d");
  context.drawImage(picture, 0, 0);
  const { data } = context.getImageData(0, 0, width, height);
  return { width, height, pixel: (at) => data.subarray(4 * at, 4 * at + 4) };
}

/** Robots save maps as PGM, which browsers do not know: binary (P5) or plain (P2), with a byte for each cell. */
function pgm(name, bytes) {
  const header = PGM.exec(ascii(bytes.subarray(0, LONGEST_HEADER)));
  const [width, height, white] = (header ?? []).slice(1).map(Number);
  if (!header || !width || !height || !white || white > WHITE) throw new Error(`${name} must be a PGM file with a byte for each cell`);
  const raster = bytes.subarray(header[0].length);
  const shades = bytes[1] === "5".charCodeAt(0) ? raster : ascii(raster).trim().split(/\s+/).map(Number);
  if (shades.length !== width * height || shades.some((shade) => !(shade <= white))) {
    throw new Error(`${name} must have ${width} x ${height} shades of at most ${white} after its header`);
  }
  const grey = (at) => toEven((shades[at] / white) * WHITE);
  return { width, height, pixel: (at) => [grey(at), grey(at), grey(at), WHITE] };
}

const ascii = (bytes) => new TextDecoder("latin1").decode(bytes);

/** The nearest whole number, of two the even one, as the service rounds. */
function toEven(value) {
  const rounded = Math.round(value);
  return rounded - value === 0.5 && rounded % 2 ? rounded - 1 : rounded;
}
