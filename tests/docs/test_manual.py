"""The manual builds strictly, and what is generated is up to date."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(
    {ROOT / "README.md", ROOT / "ARCHITECTURE.md", ROOT / "CONTRIBUTING.md", *DOCS.rglob("*.md")}
    - set((DOCS / "_build").rglob("*.md"))
)
LINK = re.compile(r"\[[^\]]*\]\(([^)#\s]+)(?:#[^)]*)?\)")
SOURCE = re.compile(r"`((?:\w+/)*\w+\.py|nodes/[\w/]+?)/?`")
SOURCES = [
    f"/{path.relative_to(ROOT)}"
    for folder in ("nodes", "schemas", "ontology", "tests", "benchmarks", "demo", "docs/_ext", "examples")
    for path in (ROOT / folder, *(ROOT / folder).rglob("*"))
]
EXAMPLES = frozenset(("nodes/a/b.py", "tests/a/test_b.py", "schemas.py"))
"""File names that stand for any file, or for a file of a user."""


@pytest.fixture
def extensions(monkeypatch):
    monkeypatch.syspath_prepend(str(DOCS / "_ext"))


def test_the_manual_builds_without_a_warning(tmp_path):
    theme = ("-D", "html_theme=basic")  # the theme of `make docs` takes half of the time
    built = subprocess.run(
        [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html", *theme, DOCS, tmp_path],
        capture_output=True,
        text=True,
        cwd=ROOT,
    )
    assert built.returncode == 0, built.stderr
    assert "<svg" in (tmp_path / "architecture.html").read_text()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_between_files_lead_somewhere(page):
    for target in LINK.findall(page.read_text()):
        if "://" not in target:
            assert (page.parent / target).exists(), target


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_source_files_and_folders_that_a_page_names_exist(page):
    named = {*SOURCE.findall(page.read_text())} - EXAMPLES
    assert [name for name in named if not any(path.endswith(f"/{name}") for path in SOURCES)] == []


def test_the_command_line_s_page_is_what_its_help_says():
    script = DOCS / "_ext" / "command_line.py"  # in a process of its own: click keeps the names of --help
    text = subprocess.check_output([sys.executable, script, "--print"], text=True)
    assert (DOCS / "command-line.md").read_text() == text, "make docs"


def test_every_diagram_is_drawn(extensions):
    import diagrams

    texts = [text for page in diagrams.PAGES for text in diagrams.BLOCK.findall(page.read_text())]
    assert {diagrams.drawn(text) for text in texts} == set(diagrams.DRAWN.glob("*.svg")), "make diagrams"


def test_the_architecture_is_one_page():
    text = (ROOT / "ARCHITECTURE.md").read_text()
    assert len(text.split()) < 1500
    assert text.count("```mermaid") == 3


def test_the_readme_is_an_entrance():
    assert len((ROOT / "README.md").read_text().splitlines()) <= 130
