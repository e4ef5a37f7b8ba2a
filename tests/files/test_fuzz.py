"""Broken files from a seed: each is read or refused in a sentence, and harmless."""

import random

import pytest
from pydantic_core import to_json

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, UnreadableFile
from tests.files.test_examples import FOLDER
from tests.fuzz.mutations import TOKENS, mutated
from tests.helpers.sampled import tenth

COUNT = tenth(2000)
BOUNDS = Bounds(cities=1000, matrix_cities=100, cells=2**14)
HOSTILE = (b"\x1b[2J", b"\x07", b"\x9b31m", "\u202e".encode(), b"\x00", b'"', b"\xff", b"-", b"nan")
NAMES = sorted(path.name for path in FOLDER.iterdir())
FILES = {name: (FOLDER / name).read_bytes() for name in NAMES}


def broken(number: int) -> NamedFile:
    rng = random.Random(number)
    name = rng.choice(NAMES)
    data = mutated(rng, FILES[name], [*TOKENS, *HOSTILE], 2000)
    if rng.random() < 0.5:
        at = rng.randrange(len(data) + 1)
        data = data[:at] + rng.choice(HOSTILE) + data[at:]
    return NamedFile(name, data)


def harmless(text: str) -> bool:
    return all(each.isprintable() or each == "\n" for each in text)


def test_a_broken_file_is_read_or_refused_in_a_sentence() -> None:
    refused = 0
    for number in range(COUNT):
        files = [broken(number), *([broken(-number - 1)] if number % 10 == 0 else [])]
        try:
            reading = read_files(files, BOUNDS, wanted=None)
        except UnreadableFile as error:
            refused += 1
            said = str(error)
        else:
            to_json(reading.document)
            said = "".join(note.text for note in reading.notes)
        assert harmless(said), number
        assert len(said) < 4000, number
    assert COUNT // 10 < refused < COUNT * 19 // 20


@pytest.mark.parametrize("piece", [b"\n", b" ", b"A:\n", b";\n", b"1,", b"[", b'"', b"POINT("])
def test_a_long_file_of_one_thing_takes_no_square_of_its_length(piece: bytes) -> None:
    with pytest.raises(UnreadableFile):
        read_files([NamedFile("a.csv", piece * 2**20)], Bounds())
