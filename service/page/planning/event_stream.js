/** Read the events that a service sends (text/event-stream, of the HTML standard) from their text. */

const LINE = /\r\n|\n|\r(?!$)/; // a carriage return at the end may be half of one

/** Turns pieces of text into events, each `{ event, data }`. */
export class EventStream extends TransformStream {
  constructor() {
    let rest = "";
    let [event, data] = ["message", []];
    super({
      transform(piece, controller) {
        const lines = (rest + piece).split(LINE);
        rest = lines.pop();
        for (const line of lines) {
          const [, name, value] = /^([^:]*):? ?(.*)$/s.exec(line);
          if (name === "event") event = value;
          else if (name === "data") data.push(value);
          if (line) continue;
          if (data.length) controller.enqueue({ event, data: data.join("\n") });
          [event, data] = ["message", []];
        }
      },
    });
  }
}
