"""What `import semmap` gives is a promise: its names are pinned here, and it is quick."""

from __future__ import annotations

import importlib
import json
import subprocess
import sys
from pathlib import Path

import pytest

import semmap
import semmap.nodes
import semmap.ontology
import semmap.schemas

PUBLIC = {
    "semmap": """
        BadFile BadRequest BodyState Changed Checked ClassInfo Client Commit Departed Document Done Entity
        Explanation Inconsistent Inferred InternalError LoggedCommit Moved NameTaken NoAnswer NodeStatus Pose
        PreconditionFailed Provenance Refused Restored RowsChanged SemmapError Sighting SparqlResult
        StandingQuery SystemStatus UnknownClass UnknownName UnknownVerb
        aio commands connect fleet local_name reasoner recordings restore testing wire
    """,
    "semmap.aio": "AsyncClient AsyncStandingQuery connect",
    "semmap.commands": """
        Add Batch Check Classes Clear Command Explain Export Get History Infer LastSeen List Load Move Pause
        Remove Reset Set Sparql Status StepOnce TakePicture Undo Unset Update
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
wall_s, cpu_s = time.perf_counter(), time.process_time()
import semmap
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


def test_every_module_of_the_package_is_one_of_these():
    modules = {path.stem for path in Path(semmap.__file__).parent.glob("*.py")}
    assert {f"semmap.{name}" for name in modules - {"__init__", "__main__"}} | {"semmap"} == set(PUBLIC)


def test_what_is_not_there_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'semmap' has no attribute 'conect'"):
        _ = semmap.conect


@pytest.fixture(scope="module")
def imported():
    """CPU seconds that `import semmap` takes, the least of some tries, and the modules that came with it."""
    tries = [json.loads(subprocess.check_output([sys.executable, "-c", MEASURE])) for _ in range(4)]
    return min(cpu_s for cpu_s, _ in tries), set(tries[0][1])


def test_it_is_imported_in_a_quarter_of_a_second(imported):
    assert imported[0] < 0.25


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
    assert "zenoh" in imported[1]
    assert not imported[1] & heavy


@pytest.mark.parametrize("package", [semmap, nodes, schemas, ontology])
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
