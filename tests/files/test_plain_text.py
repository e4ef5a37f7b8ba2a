"""Tables from terminals, chats and pages of Markdown are read as the same table in CSV."""

import pytest

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, Reading, UnreadableFile
from tests.helpers.serving import LIMITS

CSV = """name,lat,lon
Big Ben,51.5007,-0.1246
Tower,51.5081,-0.0759
Platform 9,51.5320,-0.1233
King's Cross St. Pancras,51.5308,-0.1238
"""
SAME = {
    "spaces": """name lat lon
Big Ben 51.5007 -0.1246
Tower 51.5081 -0.0759
Platform 9 51.5320 -0.1233
King's Cross St. Pancras 51.5308 -0.1238
""",
    "aligned": """name                          lat      lon

Big Ben                   51.5007  -0.1246
Tower                     51.5081  -0.0759
Platform 9                51.5320  -0.1233
King's Cross St. Pancras  51.5308  -0.1238
""",
    "name last": """lat lon name
51.5007 -0.1246 Big Ben
51.5081 -0.0759 Tower
51.5320 -0.1233 Platform 9
51.5308 -0.1238 King's Cross St. Pancras
""",
    "Markdown": """| name | lat | lon |
|------|----:|:---:|
| Big Ben | 51.5007 | -0.1246 |
| Tower | 51.5081 | -0.0759 |
| Platform 9 | 51.5320 | -0.1233 |
| King's Cross St. Pancras | 51.5308 | -0.1238 |
""",
    "Markdown without edges": """name | lat | lon
-|-|-
Big Ben | 51.5007 | -0.1246
Tower | 51.5081 | -0.0759
Platform 9 | 51.5320 | -0.1233
King's Cross St. Pancras | 51.5308 | -0.1238
""",
    "psql": """           name           |   lat   |   lon
--------------------------+---------+---------
 Big Ben                  | 51.5007 | -0.1246
 Tower                    | 51.5081 | -0.0759
 Platform 9               | 51.5320 | -0.1233
 King's Cross St. Pancras | 51.5308 | -0.1238
(4 rows)

""",
    "MySQL": """+--------------------------+---------+---------+
| name                     | lat     | lon     |
+--------------------------+---------+---------+
| Big Ben                  | 51.5007 | -0.1246 |
| Tower                    | 51.5081 | -0.0759 |
| Platform 9               | 51.5320 | -0.1233 |
| King's Cross St. Pancras | 51.5308 | -0.1238 |
+--------------------------+---------+---------+
""",
    "org": """| name                     |     lat |     lon |
|--------------------------+---------+---------|
| Big Ben                  | 51.5007 | -0.1246 |
| Tower                    | 51.5081 | -0.0759 |
| Platform 9               | 51.5320 | -0.1233 |
| King's Cross St. Pancras | 51.5308 | -0.1238 |
""",
}


def read(text: str) -> Reading:
    return read_files([NamedFile("stops.txt", text.encode())], Bounds(roads=LIMITS.roads))


@pytest.mark.parametrize("text", SAME.values(), ids=SAME)
def test_a_table_is_the_same_as_in_csv(text: str) -> None:
    assert read(text).request == read(CSV).request


def test_names_without_a_heading_are_whole() -> None:
    rows = "Big Ben 0 1 2 3\nTower 4 5 6 7\nPlatform 9 8 9 8 7\n"
    csv = "Big Ben,0,1,2,3\nTower,4,5,6,7\nPlatform 9,8,9,8,7\n"
    assert read(rows).request == read(csv).request


def test_rows_that_r_numbers_keep_their_names() -> None:
    numbered = 'name lat lon\n"1" Ben 51.5007 -0.1246\n"2" Tower 51.5081 -0.0759\n'
    assert [stop["id"] for stop in read(numbered).request["stops"]] == ["Ben", "Tower"]


def test_a_fault_below_a_drawn_line_names_its_row() -> None:
    with pytest.raises(UnreadableFile, match="row 4"):
        read(SAME["Markdown"].replace("51.5081", "fifty"))
