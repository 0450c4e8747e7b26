"""The line of a syntax error."""

from __future__ import annotations

import pyoxigraph
import pytest

from semmap.nodes.kb_node.documents.error_lines import find_error_line

GOOD = b"<http://e.org/a> <http://e.org/b> <http://e.org/c> .\n"


@pytest.mark.parametrize("before", [0, 1, 7])
def test_it_is_the_line_that_cannot_be_read(before):
    content = GOOD * before + b"<http://e.org/a> ] .\n" + GOOD * 3
    assert find_error_line(content, pyoxigraph.RdfFormat.TURTLE, "http://e.org/") == before + 1


def test_a_document_that_ends_too_early_fails_in_its_last_line():
    content = GOOD * 2 + b"<http://e.org/a> <http://e.org/b>"
    assert find_error_line(content, pyoxigraph.RdfFormat.TURTLE, "http://e.org/") == 3


def test_a_line_longer_than_one_read_of_the_parser_counts_once():
    content = GOOD + b"# " + b"x" * 100_000 + b"\n" + b"<http://e.org/a> ] .\n" + GOOD
    assert find_error_line(content, pyoxigraph.RdfFormat.TURTLE, "http://e.org/") == 3
