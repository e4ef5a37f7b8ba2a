"""The changelog says of every version what to do before an upgrade."""

import re

from tests.guide.pages import GUIDE


def test_every_version_has_its_date_and_what_to_do_before() -> None:
    versions = re.split(r"^## ", (GUIDE / "changelog.md").read_text(), flags=re.MULTILINE)[1:]
    assert len(versions) >= 2
    for version in versions:
        name, _, text = version.partition("\n")
        assert re.fullmatch(r"\d+\.\d+\.\d+", name)
        assert re.match(r"\n(?:Since|Of) \d{4}-\d\d-\d\d", text)
    for version in versions[:-1]:
        assert "**Before you upgrade** from " in version
