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
LEFT = 1_577
"""How many there are still, outside of the files below. Lower it when a folder has been rewritten."""
CLEAN = (
    "CHANGELOG.md",
    "README.md",
    "docs/explanations.md",
    "docs/glossary.md",
    "docs/index.md",
    "docs/knowledge-base.md",
    "docs/reasoner.md",
    "docs/reliability.md",
    "docs/running.md",
    "docs/scale.md",
    "docs/security.md",
    "docs/decisions/079-one-top-level-name.md",
)


def found_in(path):
    return PHRASES.findall((ROOT / path).read_text())


@pytest.mark.parametrize("path", CLEAN)
def test_a_page_that_was_rewritten_stays_free_of_them(path):
    assert found_in(path) == []


def test_there_are_no_more_of_them_than_before():
    listed = subprocess.check_output(["git", "ls-files", "*.py", "docs/*.md", "*.md"], cwd=ROOT, text=True)
    files = {name for name in listed.splitlines() if not name.startswith("benchmarks/README")} - {*CLEAN}
    assert sum(len(found_in(name)) for name in files if (ROOT / name).is_file()) <= LEFT
