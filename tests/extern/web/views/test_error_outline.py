import pytest

from semmap.nodes.extern.web.views.error_outline import Outline, fold, outline_error
from semmap.schemas.errors import unknown_classes


def test_unknown_classes_are_items():
    text = unknown_classes({f"Kind{i}": ("cup1", "cup2") for i in range(33)}, ["Table", "Kin"])
    outline = outline_error(f"the map does not fit the TBox: {text}")
    assert outline.head == "the map does not fit the TBox: unknown classes"
    assert outline.items[0] == "'Kind0' (of cup1 and 1 more; did you mean Kin?)"
    assert len(outline.items) == 4
    assert outline.items[-2:] == ("'Kind2' (of cup1 and 1 more; did you mean Kin?)", "30 more")
    assert outline.tail == "see: semmap classes; --skip-unknown leaves these out"


@pytest.mark.parametrize(
    ("text", "outline"),
    [
        ("", Outline("")),
        ("the name 'cup1' is taken; see: get cup1", Outline("the name 'cup1' is taken; see: get cup1")),
        ("unknown classes 'A', 'B'", Outline("unknown classes 'A', 'B'")),
        ("unknown classes 'A', 'B, C', 'D'", Outline("unknown classes", ("'A'", "'B, C'", "'D'"))),
        ("unknown classes 'A', 'B' and 7 more", Outline("unknown classes 'A', 'B' and 7 more")),
        ("it's, and, that's, all, there's", Outline("it's, and, that's, all, there's")),
        ("'A', 'B', 'C'", Outline("'A', 'B', 'C'")),
        ("unclosed 'A, B, C (D, E", Outline("unclosed 'A, B, C (D, E")),
        ("3 faults:\nline 1\n\nline 2\nline 3", Outline("3 faults:", ("line 1", "line 2", "line 3"))),
        ("line 1: unexpected 'x'\n  here", Outline("line 1: unexpected 'x'\n  here")),
    ],
)  # fmt: skip
def test_other_texts_stay_whole_unless_they_have_a_list(text, outline):
    assert outline_error(text) == outline


@pytest.mark.parametrize(("count", "shown"), [(0, 0), (5, 5), (6, 6), (7, 5), (40, 5)])
def test_more_than_a_few_items_are_folded(count, shown):
    items = [str(number) for number in range(count)]
    first, others = fold(items)
    assert [*first, *others] == items
    assert len(first) == shown
