"""The work that reading the files of one request may take, counted while they are read."""

UNITS = 2**20  # of about half a microsecond: half a second
LINE_OF_TEXT = 0.5  # units of a line in which keywords are looked for
LINE_OF_TABLE = 4  # units of a line of a table, more than of the text that it is in


class TooMuchWork(Exception):
    """Files take more work than their contents are worth."""


class Work:
    """The units of work that are left for the files of one request.

    All readers of files get one such budget. They spend it on what files may have without end and
    without use: bytes unpacked, elements, lines, empty rows. A field with text earns units, so that
    a long table may take longer than a file that looks short and is not.

    Args:
        units: What may be spent before anything is earned.
    """

    def __init__(self, units: int = UNITS) -> None:
        self._left = units
        self._spent = 0

    @property
    def spent(self) -> int:
        """The units that were spent."""
        return self._spent

    def spend(self, units: int) -> None:
        """Spend units.

        Raises:
            TooMuchWork: Fewer are left.
        """
        self._left -= units
        self._spent += units
        if self._left < 0:
            raise TooMuchWork

    def earn(self, units: int) -> None:
        """Add units for a field with text, which a request is made of."""
        self._left += units
