"""The documentation of the library matches the code."""

from __future__ import annotations

import ast
import re
import tomllib
from pathlib import Path

import pytest

import semmap
from semmap.nodes.extern.client_commands import CommandMethods
from semmap.nodes.extern.command_method import CommandMethod
from semmap.nodes.runtime import extras

ROOT = Path(__file__).parents[2]
PYTHON = (ROOT / "docs" / "python.md").read_text()
INSTALLATION = (ROOT / "docs" / "installation.md").read_text()
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
BLOCK = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)
PRIVATE = {"nodes", "schemas", "ontology", "semmap.nodes", "semmap.schemas", "semmap.ontology"}


def blocks():
    return [(page.name, block) for page in PAGES for block in BLOCK.findall(page.read_text())]


def imported(tree):
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, None) for alias in node.names)
        if isinstance(node, ast.ImportFrom):
            yield from ((node.module, alias.name) for alias in node.names)


@pytest.mark.parametrize(("page", "block"), blocks())
def test_examples_use_what_is_public_only(page, block):
    tree = ast.parse(block)
    for module, name in imported(tree):
        assert not {module.split(".")[0], ".".join(module.split(".")[:2])} & PRIVATE, (page, module)
        if module.split(".")[0] == "semmap" and name is not None:
            assert name in __import__(module, fromlist=["x"]).__all__, (page, name)
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "semmap":
            assert hasattr(semmap, node.attr), (page, node.attr)


def test_the_reasoner_s_example_runs(capsys):
    (example,) = (block for block in BLOCK.findall(PYTHON) if "Reasoner(" in block)
    exec(compile(example, "docs/python.md", "exec"), {})
    assert "every urn:Cup is an urn:Dish" in capsys.readouterr().out


def test_every_command_is_named():
    methods = {name for name, found in vars(CommandMethods).items() if isinstance(found, CommandMethod)}
    missing = methods - {"list_as"} - set(re.findall(r"`(\w+)`", PYTHON))
    assert missing == set(), "add these to the table of commands in docs/python.md"


def test_every_extra_has_a_row():
    assert set(re.findall(r"\| `pip install 'semmap\[(\w+)\]'`", INSTALLATION)) == {*extras.MODULES, "all"}


def test_the_citation_has_the_version():
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text()
    assert version == semmap.__version__
