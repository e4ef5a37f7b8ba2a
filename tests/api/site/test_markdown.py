"""Markdown as HTML: anchors, links, tables and the sections of a page."""

from service.api.site.markdown import Page, Section, render

TEXT = """# The page

One *word* and
[another](there.md), [a third](nowhere.txt).

## A part, `code` too

| a | b |
|---|--:|
| 1 | 2 |

## Twice

```sh
echo "x < y"
```

## Twice
"""


def rendered(text: str = TEXT) -> Page:
    return render(text, {"there.md": "there", "p.png": "pictures/p.png"}.get)


def test_a_page_is_named_by_its_first_heading() -> None:
    assert rendered().title == "The page"


def test_each_heading_has_an_anchor_of_its_own() -> None:
    anchors = [section.anchor for section in rendered().sections]
    assert anchors == ["the-page", "a-part-code-too", "twice", "twice-1"]
    for anchor in anchors:
        assert f'id="{anchor}"' in rendered().html


def test_a_section_is_what_a_reader_sees_below_its_heading() -> None:
    first, second, third, last = rendered().sections
    assert first == Section("the-page", "The page", "One word and another, a third.")
    assert second == Section("a-part-code-too", "A part, code too", "a b 1 2")
    assert third.text == 'echo "x < y"'
    assert last.text == ""


def test_a_link_leads_where_its_target_is_served_and_is_its_text_where_it_is_not() -> None:
    assert '<a href="there">another</a>, a third.' in rendered().html


def test_a_picture_has_the_address_that_it_is_served_at() -> None:
    assert '<img src="pictures/p.png" alt="A map" />' in rendered("# P\n\n![A map](p.png)").html


def test_a_table_needs_no_style_inside_the_document() -> None:
    html = rendered().html
    assert '<td class="right">2</td>' in html
    assert "style=" not in html


def test_a_table_scrolls_in_a_region_that_has_a_name_of_its_own() -> None:
    table = "\n| a |\n|---|\n| {} |\n"
    text = f'# The *first* "part"\n{table}\n{table}\n## `Last`\n{table}'
    html = rendered(text).html
    for name in ("Table: The first &quot;part&quot;", "Table 2: The first &quot;part&quot;"):
        region = f'<div class="wide" role="region" aria-label="{name}" tabindex="0"><table>'
        assert html.count(region) == 1
    assert 'aria-label="Table: Last"' in html
    assert html.count("</table></div>") == 3


def test_a_cell_of_many_words_keeps_room_for_some() -> None:
    html = rendered(f"# Page\n\n| a | b |\n|---|--:|\n| few | {'many ' * 20} |\n").html
    assert "<td>few</td>" in html
    assert '<td class="right prose">many' in html


def test_code_is_text() -> None:
    assert "echo &quot;x &lt; y&quot;" in rendered().html
