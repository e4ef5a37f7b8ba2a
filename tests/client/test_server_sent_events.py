"""The grammar of server-sent events: cases after the WHATWG's HTML standard, section 9.2."""

import pytest
from paretour.server_sent_events import EventParser, ServerSentEvent

CASES = [
    ("an event with a type", b"event: status\ndata: x\n\n", [("status", "x")]),
    ("no type is a message", b"data: x\n\n", [("message", "x")]),
    ("an empty type is a message", b"event\ndata: x\n\n", [("message", "x")]),
    ("the last type counts", b"event: a\nevent: b\ndata: x\n\n", [("b", "x")]),
    ("data over several lines", b"data: Y\ndata: +2\ndata: 10\n\n", [("message", "Y\n+2\n10")]),
    ("empty lines of data", b"data\n\ndata\ndata\n\ndata:", [("message", ""), ("message", "\n")]),
    ("one space is dropped", b"data:test\n\ndata: test\n\n", [("message", "test")] * 2),
    ("and one alone", b"data:  test\n\n", [("message", " test")]),
    ("colons in a value", b"data: a: b\n\n", [("message", "a: b")]),
    ("comments", b": heartbeat\n\n:\ndata: x\n: y\n\n", [("message", "x")]),
    ("fields that are skipped", b"retry: 9\nfoo: y\nfoo\ndata: x\n\n", [("message", "x")]),
    ("names have a case", b"DATA: y\ndata: x\n\n", [("message", "x")]),
    ("without data, no event", b"event: a\n\ndata: x\n\n", [("message", "x")]),
    ("several blank lines", b"data: x\n\n\n\ndata: y\n\n", [("message", "x"), ("message", "y")]),
    ("an event that does not end", b"data: x\n\ndata: y\n", [("message", "x")]),
    ("CRLF", b"event: a\r\ndata: x\r\n\r\n", [("a", "x")]),
    ("CR", b"event: a\rdata: x\r\r", [("a", "x")]),
    ("mixed line ends", b"event: a\rdata: x\ndata: y\r\n\n", [("a", "x\ny")]),
    ("other line ends do not count", "data: a\u2028b\u0085c\x0b\x0cd\n\n".encode(),
     [("message", "a\u2028b\u0085c\x0b\x0cd")]),
    ("UTF-8", "data: \u00e9\u20ac\U0001f600\n\n".encode(), [("message", "\u00e9\u20ac\U0001f600")]),
    ("bytes that are not UTF-8", b"data: \xff\n\n", [("message", "\ufffd")]),
    ("a byte order mark", b"\xef\xbb\xbfdata: x\n\n", [("message", "x")]),
    ("a second one", b"\xef\xbb\xbf\xef\xbb\xbfdata: x\n\n", []),
]  # fmt: skip


@pytest.mark.parametrize("size", [1, 2, 3, 5, 1000], ids=lambda size: f"{size} bytes a chunk")
@pytest.mark.parametrize(
    ("stream", "expected"), [case[1:] for case in CASES], ids=[case[0] for case in CASES]
)
def test_a_stream_is_read_alike_however_it_is_split(
    stream: bytes, expected: list[tuple[str, str]], size: int
) -> None:
    parser = EventParser()
    chunks = [stream[at : at + size] for at in range(0, len(stream), size)]
    events = [event for chunk in chunks for event in parser.feed(chunk)]
    assert events == [ServerSentEvent(*pair) for pair in expected]


def test_an_event_has_the_last_id_of_its_stream() -> None:
    stream = b"id: 7\ndata: a\n\ndata: b\n\nid: 8\0\ndata: c\n\nid: 9\n\ndata: d\n\nid\ndata: e\n\n"
    events = EventParser().feed(stream)
    assert [(event.data, event.id) for event in events] == [
        *(("a", "7"), ("b", "7"), ("c", "7"), ("d", "9"), ("e", "")),
    ]


def test_an_event_is_given_as_soon_as_its_line_ends() -> None:
    parser = EventParser()
    assert parser.feed(b"data: x\r\n\r") == [ServerSentEvent("message", "x")]
    assert parser.feed(b"\ndata: y\n\n") == [ServerSentEvent("message", "y")]
