"""Phrases that readers stumble over do not come back, in sources or documentation."""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PHRASES = re.compile(
    r"\b(?:"
    r"nobody|somebody|whoever"  # name the component or the user
    r"|is told|are told|told by|said of|is said to|hears of"  # programs report, return and receive
    r"|worked out|in vain|anew|therewith|goes by the"  # compute, without success, again, with it, uses
    r"|(?<!there )(?:is|are) no(?! longer)"  # "is not a map"
    r")\b",
    re.IGNORECASE,
)
QUOTED = frozenset(
    {
        "docs/decisions/index.md",  # names of files are kept, so that links hold
        "benchmarks/README.md",
        "tests/docs/test_wording.py",
        "tests/kb_node/answers/test_entity_search.py",  # what a person may type
        "tests/language/steps/test_commands.py",
        "tests/language/steps/test_free_wording.py",
        "nodes/language/steps/clause_starts.py",
        "nodes/language/steps/noun_phrase.py",
        "nodes/language/steps/pronoun_reader.py",
    }
)
"""Files that quote some of the phrases."""


def list_files():
    listed = subprocess.check_output(["git", "ls-files", "*.py", "*.md"], cwd=ROOT, text=True)
    return sorted(name for name in listed.splitlines() if name not in QUOTED and (ROOT / name).is_file())


def test_the_phrases_are_in_no_source_and_on_no_page():
    found = {name: PHRASES.findall((ROOT / name).read_text()) for name in list_files()}
    assert {name: phrases for name, phrases in found.items() if phrases} == {}


@pytest.mark.parametrize("name", sorted(QUOTED))
def test_a_file_with_quotations_has_few(name):
    assert 1 <= len(PHRASES.findall((ROOT / name).read_text())) <= 20


@pytest.mark.parametrize(
    "text", ["nobody publishes it", "it is no map", "Worked out anew", "there are no longer"]
)
def test_a_phrase_is_found(text):
    assert bool(PHRASES.search(text)) is not text.endswith("no longer")
