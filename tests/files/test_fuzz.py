"""Broken files, 2,000 of them from a seed: each is read or refused in a sentence, and harmless."""

import random
from pathlib import Path

import pytest
import typer
from pydantic_core import to_json

from service.cli.errors import exit_on_error
from service.cli.fleets.command import read_fleet
from service.cli.plans import plan_cities, plan_map
from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, UnreadableFile
from tests.files.test_examples import FOLDER
from tests.fuzz.mutations import TOKENS, mutated

COUNT = 2000
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
    assert 200 < refused < 1900


def test_the_command_says_what_is_wrong_with_a_broken_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for number in range(COUNT):
        file = broken(number)
        path = tmp_path / file.name
        path.write_bytes(file.data)
        code = 2
        try:
            with exit_on_error():
                if number % 3 == 0:
                    plan_cities(path, options={})
                elif number % 3 == 1:
                    read_fleet(path, None, {})
                else:
                    plan_map(path, None, {"cell_size": 1, "spacing": 1})
        except typer.Exit as ended:
            code = ended.exit_code
        assert code == 2, number
        assert harmless(capsys.readouterr().err), number


@pytest.mark.parametrize("piece", [b"\n", b" ", b"A:\n", b";\n", b"1,", b"[", b'"', b"POINT("])
def test_a_long_file_of_one_thing_takes_no_square_of_its_length(piece: bytes) -> None:
    with pytest.raises(UnreadableFile):
        read_files([NamedFile("a.csv", piece * 2**20)], Bounds())
