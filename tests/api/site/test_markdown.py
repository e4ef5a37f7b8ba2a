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
    assert '<div class="wide" tabindex="0"><table>' in html


def test_code_is_text() -> None:
    assert "echo &quot;x &lt; y&quot;" in rendered().html
