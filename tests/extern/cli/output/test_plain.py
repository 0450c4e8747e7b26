"""Tables for pipes and files."""

from semmap.nodes.extern.cli.output import plain, sparql_formats
from semmap.ontology import vocabulary as v


def test_columns_are_as_wide_as_what_is_widest_in_them():
    assert list(plain.lines(("x", "name"), [("10", "cup1"), ("1", "椅子")], (True, False))) == [
        " x  name",
        "10  cup1",
        " 1  椅子",
    ]


def test_a_row_is_a_line_whatever_it_holds():
    *_, row = plain.lines(("text",), [("a\nb\x1b[2J",)])
    assert row == r"a\nb\x1b[2J"


def test_rows_of_a_query_have_prefixed_names():
    lines = list(sparql_formats.plain_table(("thing", "size"), ((v.dm("Cup"), None),)))
    assert [line.split() for line in lines] == [["thing", "size"], ["dm:Cup"]]
