"""A store of the version before is taken over, and the changelog says what to do before."""

import re
import time
from pathlib import Path

import httpx

from tests.guide.pages import GUIDE
from tests.helpers.processes import serve_process
from tests.jobs.test_sqlite_schema import released_file


def test_the_fronts_of_the_version_before_are_there_after_the_start(
    tmp_path: Path, quick_actors: dict[str, str]
) -> None:
    store = tmp_path / "fronts.sqlite"
    with released_file(store) as database:
        # Kept lately, and of a caller without a key.
        database.execute("UPDATE front SET kept = ?, caller = 'anonymous'", (time.time(),))
        database.commit()
    settings = {"PARETOUR_STORE": str(store), "PARETOUR_WORKERS": "1", **quick_actors}
    for _ in range(2):
        with serve_process(settings) as service:
            front = httpx.get(f"{service.url}/front/done").json()
            assert (front["status"], front["points"], len(front["front"])) == ("done", 3, 2)


def test_every_version_has_its_date_and_what_to_do_before() -> None:
    versions = re.split(r"^## ", (GUIDE / "changelog.md").read_text(), flags=re.MULTILINE)[1:]
    assert len(versions) >= 2
    for version in versions:
        name, _, text = version.partition("\n")
        assert re.fullmatch(r"\d+\.\d+\.\d+", name)
        assert re.match(r"\n(?:Since|Of) \d{4}-\d\d-\d\d", text)
    for version in versions[:-1]:
        assert "**Before you upgrade** from " in version
