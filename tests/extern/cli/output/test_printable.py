"""Texts of other programs cannot control the terminal."""

from __future__ import annotations

import json

import pytest

from semmap.nodes.extern.cli.common import print_error, print_json, print_lines
from semmap.nodes.extern.cli.output.printable import print_escaped, write

CLEAR = "\x1b[2J\x1b]0;owned\x07 \x9b31m \x7f \u202e"


def commands(text):
    return [c for c in text if not c.isprintable() and c != "\n"]


@pytest.mark.parametrize("show", [print_escaped, print_error, print_json, lambda text: print_lines([text])])
def test_no_control_character_is_printed(capsys, show):
    show(f"a reference {CLEAR} of a cup")
    out, err = capsys.readouterr()
    assert commands(out + err) == []
    assert "of a cup" in out + err


def test_lines_and_letters_stay(capsys):
    print_escaped("zwei\nZeilen: \u00e4\u00f6\u00fc \u65e5\u672c")
    assert capsys.readouterr().out == "zwei\nZeilen: \u00e4\u00f6\u00fc \u65e5\u672c\n"


def test_json_is_still_the_same_json(capsys):
    print_json({"text": CLEAR})
    assert json.loads(capsys.readouterr().out) == {"text": CLEAR}


def test_a_document_is_exact_in_a_file_and_harmless_on_a_terminal(capsys, monkeypatch):
    document = f"a,b\r\n\t{CLEAR}\n"
    write(document)
    assert capsys.readouterr().out == document
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    write(document)
    shown = capsys.readouterr().out
    assert commands(shown.replace("\r", "").replace("\t", "")) == []
    assert shown.startswith("a,b\r\n\t\\x1b[2J")
