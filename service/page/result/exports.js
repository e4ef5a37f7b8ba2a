/** Write a request as a curl command, and a front as CSV. */

/** The same request as a shell command. */
export function curl({ path, body }) {
  const address = new URL(path, document.baseURI).href;
  return `curl ${address} -H 'Content-Type: application/json' -d @- <<'END'\n${JSON.stringify(body)}\nEND\n`;
}

/** A front as CSV: a tour on each line. */
export function csv(front) {
  const lines = front.map(({ angle, lengths, tour }) => [angle, ...lengths, tour.join(" ")].join(","));
  return `angle,length_1,length_2,tour\n${lines.join("\n")}\n`;
}

/** Lets the browser save a text as a file. */
export function download(name, type, text) {
  const address = URL.createObjectURL(new Blob([text], { type }));
  const link = Object.assign(document.createElement("a"), { href: address, download: name });
  link.click();
  URL.revokeObjectURL(address);
}
