"""The examples run, beside systems started as they say."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from semmap.nodes.kb_node.answers.entity_queries import CurrentState
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.runtime.class_names import ClassNames
from semmap.nodes.sim_node.models.sources import Models
from semmap.nodes.sim_node.world_file import open_world
from semmap.ontology import vocabulary as v
from semmap.schemas.bridge import Entities
from semmap.schemas.commits import NewEntity, Transaction
from semmap.schemas.relations import Where
from tests.conftest import running, until
from tests.household import household_classes
from tests.kb_node import home

EXAMPLES = Path(__file__).parents[2] / "examples"


def run(name, *words, system=None, **options):
    environment = dict(os.environ) | ({"SEMMAP_CONNECT": system.endpoint} if system else {})
    command = [sys.executable, EXAMPLES / name, *words]
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment, **options
    )


def said(process, status=0):
    out, err = process.communicate(timeout=60)
    assert process.returncode == status, err
    return out if status == 0 else err


@pytest.fixture(scope="module")
def flat(flat_map):
    return flat_map


def test_a_shopping_list(flat):
    assert said(run("shopping_list.py", "Milk", "Bread", "Tomato", system=flat)) == "buy: Tomato\n"
    assert "did you mean Tomato" in said(run("shopping_list.py", "Tomatoe", system=flat), status=1)


def test_a_watcher(flat):
    watcher = run("watcher.py", system=flat)
    assert watcher.stdout.readline() == "drinks: milk1 water1\n"
    with flat.client() as client:
        client.add("Beer", "beer1", at=(8.0, 2.3, 0.75), reason="for the test")
        client.remove("beer1")
    awaited, told = {"for the test (beer1)", "a drink came: beer1", "a drink went: beer1"}, []
    while awaited and (line := watcher.stdout.readline()):
        told.append(line)
        awaited = {text for text in awaited if text not in line}
    watcher.terminate()
    watcher.communicate()
    assert not awaited, told


def test_a_watcher_ends_when_nothing_happens(flat):
    assert said(run("watcher.py", "0.5", system=flat)) == "drinks: milk1 water1\n"


def test_a_robot_s_tests():
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", EXAMPLES / "test_tidy_up.py"],
        capture_output=True,
        text=True,
    )
    assert "3 passed" in done.stdout, done.stdout


# Where the scene is the truth, bodies become entities: see `test_restart.py`.
def test_a_world_of_one_s_own_has_bodies_of_known_classes(tmp_path):
    world = open_world(EXAMPLES / "workbench.xml", Models(), classes=ClassNames(household_classes()))
    world.step(0.5)
    bodies = {body.name: body for body in world.scene().bodies}
    classes = {name: body.class_ for name, body in bodies.items()}
    assert classes == {"bench": "Table", "mug": "Cup", "box_1": "Box"}
    semantic_map = SemanticMap(home.new_household_journal(tmp_path))
    add = [
        NewEntity(name=body.name, class_iri=v.bare(v.dm(body.class_)), pose=body.pose, size=body.size_m)
        for body in bodies.values()
    ]
    semantic_map.commit(Transaction(id="bodies", source="scene", add=tuple(add)))
    on_bench = CurrentState(semantic_map).entities(Entities(where=Where(on="bench")))
    assert {entity.name for entity in on_bench} == {"mug", "box_1"}
    home.close(semantic_map)


def test_a_camera_of_one_s_own_fills_the_map(tmp_path):
    words = ("--abox", "none", "--world", "empty", "--truth", "perceived", "--perception", "--camera-hz", "0")
    with running(tmp_path, *words, "--no-record") as system:
        camera = run("own_camera.py", "60", system=system)
        try:
            with system.client() as client:
                box = until(lambda: [e for e in client.list() if e.pose.position_m[2] > 0.7], "it is seen")[0]
        finally:
            camera.terminate()
            camera.communicate()
        assert box.pose.position_m == pytest.approx((0.05, 0.06, 0.74), abs=0.03)
