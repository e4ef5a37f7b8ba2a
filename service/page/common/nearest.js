/** Find the name that somebody may have meant. */

/** The name that differs least from a text, by at most a third of its letters; undefined if there is none. */
export function nearest(text, names) {
  const wanted = text.toLowerCase();
  const most = Math.ceil(text.length / 3);
  const near = names.filter((name) => Math.abs(name.length - text.length) <= most);
  const [best] = near.map((name) => [changes(wanted, name.toLowerCase()), name]).sort(([one], [other]) => one - other);
  return best?.[0] <= most ? best[1] : undefined;
}

/** The fewest letters to add, drop or change that make one text of another. */
function changes(one, other) {
  let row = Array.from({ length: other.length + 1 }, (_, at) => at);
  for (const [at, letter] of [...one].entries()) {
    const next = [at + 1];
    for (let to = 0; to < other.length; to++) {
      next.push(Math.min(next[to] + 1, row[to + 1] + 1, row[to] + (letter === other[to] ? 0 : 1)));
    }
    row = next;
  }
  return row.at(-1);
}
