"""Parse server-sent events, by the grammar in section 9.2 of the WHATWG's HTML standard.

Reconnection times are skipped: the client has its own.
"""

import codecs
import re
from dataclasses import dataclass

from paretour.expect import UnexpectedAnswer

_LONGEST = 2**18  # characters of an event
_LINE_END = re.compile("\r\n|\r|\n")


@dataclass(frozen=True)
class ServerSentEvent:
    """An event: its type, its data, and the id that the stream had by then.

    Lines of data are separated by line feeds.
    """

    type: str
    data: str
    id: str = ""


class EventParser:
    """A parser of one stream. It takes chunks of bytes that may end anywhere."""

    def __init__(self) -> None:
        # "utf-8-sig" drops a byte order mark at the beginning, as the standard demands.
        self._decoder = codecs.getincrementaldecoder("utf-8-sig")(errors="replace")
        self._after_return = False  # whether a line feed now belongs to the last line end
        self._line = ""
        self._type = ""
        self._id = ""
        self._data: list[str] = []
        self._length = 0  # characters of the data so far

    def feed(self, chunk: bytes) -> list[ServerSentEvent]:
        """Return the events that end in a chunk.

        Raises:
            UnexpectedAnswer: An event is too long.
        """
        text = self._decoder.decode(chunk)
        if not text:
            return []
        if self._after_return:
            text = text.removeprefix("\n")
        self._after_return = text.endswith("\r")
        *lines, self._line = _LINE_END.split(self._line + text)
        events = [event for line in lines if (event := self._read(line)) is not None]
        if max(len(self._line), self._length) > _LONGEST:
            raise UnexpectedAnswer(f"an event must have at most {_LONGEST} characters, got more")
        return events

    def _read(self, line: str) -> ServerSentEvent | None:
        """Return the event that this line ends: an empty line does, if data came before it."""
        if not line:
            return self._dispatch()
        field, _, value = line.partition(":")  # in a comment, the field is empty
        value = value.removeprefix(" ")
        if field == "event":
            self._type = value
        elif field == "data":
            self._data.append(value)
            self._length += len(value) + 1
        elif field == "id" and "\0" not in value:
            self._id = value
        return None

    def _dispatch(self) -> ServerSentEvent | None:
        event = ServerSentEvent(self._type or "message", "\n".join(self._data), self._id)
        ended = bool(self._data)
        self._type, self._data, self._length = "", [], 0
        return event if ended else None
