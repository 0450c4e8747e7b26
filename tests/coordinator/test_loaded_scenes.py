"""Scene files and HuRIC maps in the household map, and the bodies that a simulator creates of them."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET

import pytest

from semmap.nodes.coordinator.reconciler.reconcile import body_order
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.runtime.class_names import ClassNames
from semmap.nodes.sim_node.models.sources import Models
from semmap.nodes.sim_node.world import World
from semmap.nodes.sim_node.world_file import open_world
from semmap.schemas import commands as c
from semmap.schemas import errors
from tests.coordinator.conftest import new_dispatcher
from tests.data import data_folder
from tests.household import household_classes
from tests.kb_node import home

CLASSES = ClassNames(household_classes())
EVERY = 24
"""The default tests take each 24th map of the corpus; `make test-long` takes all."""
FURNITURE = [
    {"class": class_, "name": name, "at": [i, 2, 0]}
    for i, (name, class_) in enumerate(
        [
            ("chair_7", "Chair"),
            ("milk", "Milk"),
            ("beer", "Beer"),
            ("water", "Water"),
            ("coffee", "Coffee"),
            ("dining_table", "Dining_Table"),
            ("door", "Door"),
        ]
    )
]


@pytest.fixture(scope="module")
def dispatcher(tmp_path_factory):
    """A dispatcher with the household TBox."""
    semantic_map = SemanticMap(home.new_household_journal(tmp_path_factory.mktemp("household")))
    yield new_dispatcher(semantic_map)
    home.close(semantic_map)


def load(dispatcher, content, filename, **fields):
    """Replace the map by a file."""
    return dispatcher.change(c.Load(content=content, filename=filename, replace=True, **fields))


def spawn(entities):
    """Return the bodies of entities in an empty world, by their names."""
    world = World()
    spawned = world.spawn([body_order(entity, entity.pose) for entity in entities if not entity.place])
    assert spawned.failed == {}
    return {body.name: body for body in world.scene().bodies}


def described_by(bodies):
    return {name: (body.class_, body.model, body.size_m, body.fixed) for name, body in bodies.items()}


def test_a_file_makes_the_same_bodies_as_a_world_and_when_it_is_loaded(dispatcher, tmp_path):
    file = tmp_path / "scene.json"
    file.write_text(json.dumps({"entities": FURNITURE}))
    as_world = {body.name: body for body in open_world(file, Models(), classes=CLASSES).scene().bodies}
    load(dispatcher, file.read_bytes(), file.name)
    loaded = spawn(dispatcher.map.entities.values())
    assert {name: body.class_ for name, body in loaded.items()} == {f["name"]: f["class"] for f in FURNITURE}
    assert described_by(as_world) == described_by(loaded)


def spatial(name):
    """Return the class of things in space with this name; None if it is unknown."""
    try:
        return CLASSES.spatial(name)
    except errors.UnknownClass:
        return None


def maps():
    return sorted((data_folder() / "huric").rglob("*.hrc"))


def require_loaded(dispatcher, path):
    described = ET.parse(path).findall("./semanticMap/entities/entity")
    known = {e.get("atom"): e for e in described if spatial(e.get("type")) is not None}
    unknown = [e for e in described if e.get("atom") not in known]
    content = path.read_bytes()
    if unknown:
        with pytest.raises(errors.UnknownClass) as refusal:
            load(dispatcher, content, path.name)
        assert all(f"'{e.get('type')}'" in refusal.value.text for e in unknown)
    reply = load(dispatcher, content, path.name, skip_unknown=True)
    assert len(reply.skipped) == len(unknown)
    entities = dispatcher.map.entities
    assert set(entities) == set(known)
    for name, entity in entities.items():
        place = known[name].find("coordinate")
        assert entity.class_ == spatial(known[name].get("type")).name
        x, y, _ = entity.pose.position_m
        assert (x, y) == pytest.approx((float(place.get("x")), float(place.get("y"))), abs=0.05), name
    assert spawn(entities.values()).keys() == {name for name, entity in entities.items() if not entity.place}


def test_maps_of_the_corpus(dispatcher):
    for path in maps()[::EVERY]:
        require_loaded(dispatcher, path)


@pytest.mark.long
def test_every_map_of_the_corpus(dispatcher):
    for path in maps():
        require_loaded(dispatcher, path)
