"""The file of the store: its version, who may read it, and files that are refused."""

import os
import sqlite3
import stat
from contextlib import closing
from pathlib import Path

import pytest

from service.jobs.sqlite_schema import STEPS, migrate, open_file
from service.jobs.sqlite_store import SqliteStore
from tests.helpers.version_before import write_store


def version(database: sqlite3.Connection) -> int:
    found: int = database.execute("PRAGMA user_version").fetchone()[0]
    return found


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def test_a_new_file_has_what_one_of_the_version_before_has(tmp_path: Path) -> None:
    with (
        closing(open_file(str(write_store(tmp_path / "old")))) as old,
        closing(open_file(str(tmp_path / "new"))) as new,
    ):
        assert version(old) == version(new)
        for table in ("front", "gone", "delivery"):
            columns = [
                {name for (name,) in each.execute("SELECT name FROM pragma_table_info(?)", [table])}
                for each in (old, new)
            ]
            # Requests once had a file beside them.
            assert columns[0] - {"upload"} == columns[1]


def test_steps_are_taken_all_or_none(tmp_path: Path) -> None:
    with closing(sqlite3.connect(write_store(tmp_path / "old"))) as database:
        before, latest = list(database.iterdump()), version(database)
        with pytest.raises(sqlite3.Error):
            migrate(database, (*STEPS, "ALTER TABLE none ADD COLUMN one;"))
        assert (version(database), list(database.iterdump())) == (latest, before)
        migrate(database, (*STEPS, "ALTER TABLE front ADD COLUMN one;"))
        assert version(database) == latest + 1
        database.execute("SELECT one FROM front")


def test_a_file_of_a_later_release_is_refused_and_left_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "later"
    with closing(open_file(str(path))) as database:
        later = version(database) + 1
        database.execute(f"PRAGMA user_version = {later}")
    before = path.read_bytes()
    with pytest.raises(ValueError, match=rf"of version {later}, of a later release, and"):
        SqliteStore(str(path), entries=1, max_age=1)
    assert path.read_bytes() == before


def test_the_file_and_those_beside_it_are_their_owners_alone(tmp_path: Path) -> None:
    new, old = tmp_path / "new", write_store(tmp_path / "old")
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
        ("CREATE TABLE front (id); PRAGMA user_version = 3", "of version 0.1; start 0.2"),
        ("CREATE TABLE front (id); CREATE TABLE gone (id)", "damaged"),
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
