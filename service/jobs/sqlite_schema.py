"""The schema of the store's SQLite file, and the steps from each version to the next.

To change the schema, add a step to `STEPS` and change nothing in the earlier ones: files that they
made are in use. The version of a file is its `PRAGMA user_version`.
"""

import os
import sqlite3
import stat
from collections.abc import Sequence
from contextlib import closing
from functools import partial
from pathlib import Path

from service.jobs.store import COLUMNS

IN_MEMORY = ":memory:"
UNFINISHED = "status IN ('queued', 'running')"
_PRIVATE = stat.S_IRUSR | stat.S_IWUSR  # others must not read the requests

_FIRST = 4  # the version of files that 0.2.0 wrote
STEPS = (
    # From no file to the first version.
    f"""
    CREATE TABLE front (
        number INTEGER PRIMARY KEY, kept REAL, {", ".join(COLUMNS)},
        size INTEGER NOT NULL DEFAULT 0, client, webhook
    );
    CREATE UNIQUE INDEX by_id ON front (id);
    CREATE UNIQUE INDEX by_key ON front (caller, key) WHERE key IS NOT NULL;
    CREATE INDEX by_caller ON front (caller, number);
    CREATE INDEX finished ON front (client, number, kept, size) WHERE NOT {UNFINISHED};
    CREATE TABLE gone (number INTEGER PRIMARY KEY, id, caller, client);
    CREATE INDEX gone_by_id ON gone (id);
    CREATE TABLE delivery (id PRIMARY KEY, webhook, status, ended REAL, attempts INTEGER, due REAL);
    CREATE INDEX delivery_by_due ON delivery (due);
    """,
)


def open_file(path: str) -> sqlite3.Connection:
    """Open the store's file, which only its owner may read, in the present version.

    Raises:
        OSError: The file cannot be made or opened.
        sqlite3.Error: It is not a file of SQLite, or another process has it.
        ValueError: It is another program's, damaged, or of a release that is later, or too early.
    """
    if path != IN_MEMORY:
        _create(Path(path))
    database = sqlite3.connect(path, check_same_thread=False, timeout=1)
    # A damaged text must not prevent reading the rest.
    database.text_factory = partial(str, encoding="utf-8", errors="replace")
    try:
        database.execute("PRAGMA locking_mode = EXCLUSIVE")
        _check(database)
        if path != IN_MEMORY:
            _make_private(path)
        database.execute("PRAGMA journal_mode = WAL")
        database.execute("PRAGMA synchronous = NORMAL")
        migrate(database, STEPS)
    except BaseException:
        database.close()
        raise
    return database


def copy_file(database: sqlite3.Connection, path: str) -> None:
    """Copy an open store to a file beside it, which only its owner may read.

    The copy has its name, ending in `.backup`, once it is whole.

    Raises:
        OSError: The copy cannot be made.
        sqlite3.Error: Likewise, mostly because the disk is full.
        ValueError: The store is in memory.
    """
    if path == IN_MEMORY:
        raise ValueError("it is in memory, and PARETOUR_STORE names no file")
    unfinished = Path(f"{path}.backup.part")
    unfinished.unlink(missing_ok=True)
    _create(unfinished)
    with closing(sqlite3.connect(unfinished)) as copy:
        database.backup(copy)
    unfinished.replace(f"{path}.backup")


def migrate(database: sqlite3.Connection, steps: Sequence[str]) -> None:
    """Apply the missing steps to a database, all of them or none."""
    version = _version(database)
    outstanding = "".join(steps[version and version - _FIRST + 1 :])
    latest = _FIRST + len(steps) - 1
    try:
        database.executescript(
            f"BEGIN IMMEDIATE; {outstanding} PRAGMA user_version = {latest}; COMMIT;"
        )
    except BaseException:
        database.rollback()
        raise


def _version(database: sqlite3.Connection) -> int:
    [version] = database.execute("PRAGMA user_version").fetchone()
    return int(version)


def _check(database: sqlite3.Connection) -> None:
    """Raise ValueError if a file is damaged, not the store's, or of a version that is not read."""
    version, latest = _version(database), _FIRST + len(STEPS) - 1
    if version > latest:
        raise ValueError(
            f"it is of version {version}, of a later release, and this one reads {latest} at most;"
            " start that release, or name another file"
        )
    [[found]] = database.execute("PRAGMA quick_check(1)")
    if found != "ok":
        raise ValueError(f"it is damaged: {found}")
    tables = {name for (name,) in database.execute("SELECT name FROM sqlite_master")}
    if tables and "front" not in tables:
        raise ValueError("it is another program's")
    if tables and version < _FIRST:
        raise ValueError("it is of version 0.1; start 0.2 with it once, which this release reads")


def _create(path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists():
        # SQLite gives its auxiliary files the same mode.
        os.close(os.open(path, os.O_RDWR | os.O_CREAT, _PRIVATE))
    elif not path.is_file():
        raise ValueError("it is not a regular file")


def _make_private(path: str) -> None:
    for file in (path, f"{path}-wal", f"{path}-shm", f"{path}-journal"):
        if Path(file).exists():
            Path(file).chmod(_PRIVATE)
