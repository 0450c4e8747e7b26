"""The public names of `import semmap` are fixed, and the import is fast."""

from __future__ import annotations

import ast
import importlib
import inspect
import json
import subprocess
import sys
import typing
from pathlib import Path

import msgspec
import pytest

import semmap
import semmap.nodes
import semmap.ontology
import semmap.schemas
from semmap.schemas.calls import reply_type
from tests.conftest import until

PUBLIC = {
    "semmap": """
        Account Antecedent Argument BackupPart BadFile BadRequest BodyState Busy Candidate Change
        Changed Checked ClassInfo Client CommandStep Commit Compacted Departed Described Difference
        Document Done Entity Episode Explanation Extent Filler Found Frame Grounded Inconsistent Inferred
        InternalError Joint LessonTold Live LoggedCommit Moved NameTaken NoAnswer NodeStatus Opening
        Outline PastAnswer Picture PlaceChanges PlaceRelation Plan PlannedPlace PlannedThing Pose Possible
        PreconditionFailed PropertyInfo Provenance Refused Related Relation Request Restored
        RowsChanged RuleInfo SemanticFrame SemmapError ShownView Sighting SparqlResult Spell Spells
        StandingQuery Step SystemStatus ThingDescription Trail TrailPoint Understood UnknownClass UnknownName
        UnknownVerb Violation Visit Watching Way aio commands connect fleet local_name reasoner recordings
        restore testing wire
    """,
    "semmap.aio": "AsyncClient AsyncStandingQuery connect",
    "semmap.commands": """
        Add Approve Attach Backup Batch Check Classes Clear Close Command Compact Could Detach Diff
        Drive Explain Export Find FindTrail FindWay Forget Get History Infer LastSeen Learn Learned List
        ListFrames Load Move Open Pause PlanFloor Properties Relations Remove Rename Renew Reset Rules
        Set Sparql
        Status StepOnce Submit TakePicture Tell Track Understand Undo Unset Update WasWhen Watch
    """,
    "semmap.fleet": "Answer CopiedRobot FleetAnswer Frame Mirror Robots mirror robots sparql",
    "semmap.reasoner": "Change Explanation Inconsistent Reasoner Step Term Triple",
    "semmap.recordings": "Film check movie replay",
    "semmap.testing": "free_endpoint own_system",
    "semmap.wire": """
        ACK COMMIT ENTITY HEALTH MASKS OBSERVATIONS POSES Ack CameraFrame CameraView DetectedMasks Health
        MaskImage
        MaskRun Observation Observations Poses Topic camera_key decode encode entity_key
    """,
}

MEASURE = """
import sys, time
cpu_s = time.process_time()
import semmap
[getattr(semmap, name) for name in semmap.__all__ if name[0].isupper() or name == "connect"]
print(__import__("json").dumps([time.process_time() - cpu_s, sorted(m for m in sys.modules if "." not in m)]))
"""


@pytest.mark.parametrize("module", PUBLIC)
def test_the_public_names_are_these(module):
    """To add one is a decision, and to take one away breaks programs: CHANGELOG.md says so."""
    imported = importlib.import_module(module)
    assert sorted(imported.__all__) == sorted(PUBLIC[module].split())
    assert len(set(imported.__all__)) == len(imported.__all__)
    for name in imported.__all__:
        assert getattr(imported, name) is not None


def mentioned(hint, found):
    """Add to `found` every class of ours that a type hint mentions, with those of the fields of Structs."""
    for part in hint if isinstance(hint, list) else typing.get_args(hint):
        mentioned(part, found)
    if isinstance(hint, type) and hint.__module__.startswith("semmap.") and hint not in found:
        found.add(hint)
        if issubclass(hint, msgspec.Struct):
            for field in typing.get_type_hints(hint).values():
                mentioned(field, found)


def test_what_commands_take_and_return_is_public():
    requests = {getattr(semmap.commands, name) for name in semmap.commands.__all__} - {
        semmap.commands.Command
    }
    found = set()
    for request in requests:
        mentioned(request, found)
        mentioned(reply_type(request), found)
    for method in (*vars(semmap.Client).values(), *vars(semmap.aio.AsyncClient).values()):
        if inspect.isfunction(method) and not method.__name__.startswith("_"):
            for hint in typing.get_type_hints(method).values():
                mentioned(hint, found)
    public = {
        getattr(module, name) for module in (semmap, semmap.aio, semmap.commands) for name in module.__all__
    }
    assert {kind.__qualname__ for kind in found - public} == set()


def test_a_command_is_public_unless_only_semmap_sends_it():
    every = {kind.__name__ for kind in semmap.schemas.commands.COMMANDS.values()}
    missing = every - set(semmap.commands.__all__)
    assert missing == set(), "add these to __all__ in schemas/commands.py"


def test_every_public_name_is_imported_from_where_type_checkers_find_it():
    tree = ast.parse(Path(semmap.__file__).read_text())
    imports = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.module.startswith("semmap.")
    ]
    for_checkers = {alias.name: node.module for node in imports for alias in node.names}
    assert {name: f"semmap.{module}" for name, module in semmap._MODULE_OF.items()} == for_checkers
    assert for_checkers.keys() | semmap._MODULES == set(semmap.__all__)


def test_every_module_of_the_package_is_one_of_these():
    modules = {path.stem for path in Path(semmap.__file__).parent.glob("*.py")}
    assert {f"semmap.{name}" for name in modules - {"__init__", "__main__"}} | {"semmap"} == set(PUBLIC)


def test_what_is_not_there_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'semmap' has no attribute 'conect'"):
        _ = semmap.conect


def measured():
    """Import `semmap` in a new process; return its CPU seconds and modules."""
    return json.loads(subprocess.check_output([sys.executable, "-c", MEASURE]))


@pytest.fixture(scope="module")
def imported():
    """The modules that come with `import semmap`."""
    return set(measured()[1])


def test_it_is_imported_in_a_quarter_of_a_second():
    until(lambda: measured()[0] < 0.25, "one of some tries takes so little CPU time")


def test_it_brings_nothing_that_only_a_node_or_the_command_line_needs(imported):
    heavy = {
        "numpy",
        "mujoco",
        "rerun",
        "scipy",
        "pyoxigraph",
        "rdflib",
        "owlrl",
        "supervisor",
        "click",
        "rich",
    }
    assert "zenoh" in imported
    assert not imported & heavy


@pytest.mark.parametrize("package", [semmap, semmap.nodes, semmap.schemas, semmap.ontology])
def test_its_types_are_for_type_checkers(package):
    assert (Path(package.__path__[0]) / "py.typed").exists()


def test_it_runs_as_the_command_line():
    said = subprocess.check_output([sys.executable, "-m", "semmap", "--version"], text=True)
    assert semmap.__version__ in said


def test_the_reasoner_needs_no_system():
    a, sub_class_of = (
        "<http://www.w3.org/1999/02/22-rdf-syntax-ns#type>",
        "<http://www.w3.org/2000/01/rdf-schema#subClassOf>",
    )
    reasoner = semmap.reasoner.Reasoner([("<urn:Cup>", sub_class_of, "<urn:Dish>")])
    reasoner.apply(insert=[("<urn:cup1>", a, "<urn:Cup>")])
    assert "every urn:Cup is an urn:Dish" in reasoner.explain(("<urn:cup1>", a, "<urn:Dish>")).text
