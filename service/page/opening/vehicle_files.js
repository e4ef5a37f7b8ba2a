/** Recognise files of vehicles by their heading, so that they are read with the stops that they serve. The service says what each column is. */

const NAMES = /\.(csv|tsv|txt)$/i;
const HEADING = 2000; // letters, of which the heading is the first row
const OF_VEHICLES = /driver|vehicle|capacity|plate|shift|fahrer|fahrzeug|kapazit|kennzeichen/i;
const OF_STOPS = /\b(lat|lon|lng|x|y)\b|latitude|longitude|address|location|demand|window/i;

/** Whether all files are tables of vehicles, as far as their headings tell. */
export async function areOfVehicles(files) {
  const each = await Promise.all([...files].map(isOfVehicles));
  return each.every(Boolean);
}

async function isOfVehicles(file) {
  if (!NAMES.test(file.name)) return false;
  const begin = await file.slice(0, HEADING).text().catch(() => ""); // what cannot be read is said where it is read
  const [heading] = begin.split(/[\r\n]/);
  return OF_VEHICLES.test(heading) && !OF_STOPS.test(heading.replaceAll("_", " "));
}
