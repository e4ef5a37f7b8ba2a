"""The page reads the events of a stream, wherever their text is cut."""

import pytest

from tests.helpers.node import Node

READ = """async (pieces) => {
  const { EventStream } = await import("./page/planning/event_stream.js");
  const found = [];
  const text = new ReadableStream({
    start(controller) {
      for (const each of pieces) controller.enqueue(each);
      controller.close();
    },
  });
  const events = text.pipeThrough(new EventStream());
  for await (const { event, data } of events) found.push([event, data]);
  return found;
}"""
TEXT = (
    ': keep\r\n\r\nevent: front\r\ndata: {"name":"a: \N{LINE SEPARATOR}"}\r\nid: 7\r\n\r\n'
    "event: left out\n\ndata:one\ndata: two\n\ndata: not ended\n"
)
EVENTS = [["front", '{"name":"a: \N{LINE SEPARATOR}"}'], ["message", "one\ntwo"]]


@pytest.mark.parametrize("length", [1, 2, 7, 1000])
def test_events_are_read_wherever_their_text_is_cut(node: Node, length: int) -> None:
    pieces = [TEXT[at : at + length] for at in range(0, len(TEXT), length)]
    assert node.evaluate(READ, pieces) == EVENTS
