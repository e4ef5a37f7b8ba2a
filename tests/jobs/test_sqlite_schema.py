"""The file of the store: its version, who may read it, and files that are refused."""

import os
import sqlite3
import stat
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import pytest

from service.jobs.sqlite_schema import STEPS, migrate, open_file
from service.jobs.sqlite_store import SqliteStore
from tests.helpers.released_records import SQLITE_ROWS, SQLITE_SCHEMA


@contextmanager
def released_file(path: Path) -> Iterator[sqlite3.Connection]:
    with closing(sqlite3.connect(path)) as database:
        database.executescript(SQLITE_SCHEMA)
        for row in SQLITE_ROWS:
            places = ", ".join("?" * len(row))
            database.execute(f"INSERT INTO front VALUES ({places})", tuple(row.values()))
        database.commit()
        yield database


def version(database: sqlite3.Connection) -> int:
    found: int = database.execute("PRAGMA user_version").fetchone()[0]
    return found


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def test_a_file_without_a_version_gets_all_steps_and_keeps_its_records(tmp_path: Path) -> None:
    with released_file(tmp_path / "old") as database:
        assert version(database) == 0
    with closing(open_file(str(tmp_path / "old"))) as database:
        assert version(database) == len(STEPS)
        sizes = dict(database.execute("SELECT id, size FROM front").fetchall())
    stored: list[dict[str, Any]] = SQLITE_ROWS
    for row in stored:
        values = [value for name, value in row.items() if name not in ("number", "kept")]
        assert sizes[row["id"]] == sum(len(value) for value in values if value is not None)
    with (
        closing(open_file(str(tmp_path / "old"))) as old,
        closing(open_file(str(tmp_path / "new"))) as new,
    ):
        columns = "SELECT name FROM pragma_table_info('front')"
        assert old.execute(columns).fetchall() == new.execute(columns).fetchall()


def test_steps_are_taken_all_or_none(tmp_path: Path) -> None:
    with released_file(tmp_path / "old") as database:
        before = list(database.iterdump())
        with pytest.raises(sqlite3.Error):
            migrate(database, (*STEPS, "ALTER TABLE none ADD COLUMN one;"))
        assert (version(database), list(database.iterdump())) == (0, before)
        migrate(database, (*STEPS, "ALTER TABLE front ADD COLUMN one;"))
        assert version(database) == len(STEPS) + 1


def test_a_file_of_a_later_release_is_refused_and_left_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "later"
    open_file(str(path)).close()
    with closing(sqlite3.connect(path)) as database:
        database.execute(f"PRAGMA user_version = {len(STEPS) + 1}")
    before = path.read_bytes()
    with pytest.raises(ValueError, match=rf"of version {len(STEPS) + 1}, of a later release, and"):
        SqliteStore(str(path), entries=1, max_age=1)
    assert path.read_bytes() == before


def test_the_file_and_those_beside_it_are_their_owners_alone(tmp_path: Path) -> None:
    new, old = tmp_path / "new", tmp_path / "old"
    with released_file(old):
        pass
    wal = tmp_path / "old-wal"
    wal.touch()
    for path in (old, wal):
        path.chmod(0o644)
    before = os.umask(0)
    try:
        for path in (new, old):
            with closing(open_file(str(path))) as database:
                database.execute("CREATE TABLE one (two)")
                beside = list(tmp_path.glob(f"{path.name}*"))
                assert len(beside) > 1
                assert {mode(each) for each in beside} == {0o600}
    finally:
        os.umask(before)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"root:x:0:0:", "file is not a database"),
        ("CREATE TABLE notes (text)", "another program's"),
        (SQLITE_SCHEMA, "damaged"),
    ],
)
def test_a_file_that_is_not_the_stores_is_refused_and_left_as_it_is(
    tmp_path: Path, content: str | bytes, reason: str
) -> None:
    path = tmp_path / "file"
    if isinstance(content, bytes):
        path.write_bytes(content * 100)
    else:
        with closing(sqlite3.connect(path)) as database:
            database.executescript(content)
        if reason == "damaged":
            pages = bytearray(path.read_bytes())
            pages[4096:4200] = b"\xff" * 104
            path.write_bytes(pages)
    path.chmod(0o644)
    before = path.read_bytes()
    with pytest.raises(ValueError, match=f"must be a file of its own, {path} is not: .*{reason}"):
        SqliteStore(str(path), entries=1, max_age=1)
    assert (path.read_bytes(), mode(path)) == (before, 0o644)


def test_a_device_is_refused_and_keeps_its_mode() -> None:
    before = mode(Path(os.devnull))
    with pytest.raises(ValueError, match="not a regular file"):
        SqliteStore(os.devnull, entries=1, max_age=1)
    assert mode(Path(os.devnull)) == before
