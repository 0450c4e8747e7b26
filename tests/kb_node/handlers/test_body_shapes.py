"""The shapes of a world's bodies arrive from the simulator, and remain beside the journal."""

import msgspec
import pytest
from msgspec import structs

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.handlers.body_shapes import ShapeHandlers
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage import body_shapes
from semmap.ontology import FLAT_TTL, model_shapes
from semmap.ontology import vocabulary as v
from semmap.ontology.model_shapes import ConvexPart, ModelShape, Surface, WorldShapes
from semmap.schemas import errors
from semmap.schemas.bridge import ShapeBodies, ShapeKey, ShapesOf
from semmap.schemas.commits import Edit, Transaction
from tests.kb_node import home
from tests.kb_node.test_places_as_facts import state

FLAT = tuple(rdf.parse(FLAT_TTL.read_bytes(), "flat.ttl", label_prefix="f"))
BOWL = "bowl1"


@pytest.fixture
def flat(tmp_path, monkeypatch):
    monkeypatch.setattr(model_shapes, "_world", WorldShapes())
    made = SemanticMap(home.new_household_journal(tmp_path))
    made.commit(Transaction(id="flat", source="file", insert=FLAT))
    yield made
    made._journal.close()


class Shapes(ShapeHandlers):
    def __init__(self, semantic_map, file):
        self.told = []
        super().__init__(semantic_map, file, self.told.append)


@pytest.fixture
def handlers(flat, tmp_path):
    return Shapes(flat, tmp_path / body_shapes.FILENAME)


def solid(size):
    """Return a block without a hollow, which supports objects on its whole top."""
    x, y, z = size
    half = ((x / 2, 0.0, 0.0), (0.0, y / 2, 0.0), (0.0, 0.0, z / 2))
    return ModelShape(
        size_m=size,
        surfaces=(Surface(height=z, low=(-x / 2, -y / 2), high=(x / 2, y / 2)),),
        parts=(ConvexPart(centre=(0.0, 0.0, z / 2), straight=half),),
        turns=False,
    )


def message(**by_name):
    return ShapeBodies(content=msgspec.json.encode(WorldShapes.of(by_name)))


def size_of(flat, name):
    return flat.entity(name).size_m or model_shapes.own_size_m(flat.entity(name).model)


def contents(flat):
    inside = v.dm("isInside")
    facts = flat.reasoner.given(None, inside, v.iri(flat.entity(BOWL).iri))
    return {v.entity_name(subject) for subject, _, _ in facts}


def test_relations_follow_shapes_that_arrive_and_are_those_of_a_start_with_them(flat, handlers):
    flat.derive_all()
    before = state(flat)
    assert (within := contents(flat))
    handlers.on_shapes(message(**{BOWL: solid(size_of(flat, BOWL)), "unknown1": solid((1.0, 1.0, 1.0))}))
    assert not contents(flat)
    (told,) = handlers.told
    assert {BOWL, *within} <= told
    changed = state(flat)
    assert changed != before
    flat.checkpoint()
    again = home.reopened(flat)
    again.derive_all()
    assert state(again) == changed
    assert (flat.exchange_shapes(WorldShapes()), state(flat)) == (told, before)
    again._journal.close()


def test_a_start_after_shapes_were_stored_but_not_yet_followed_has_their_relations(flat, handlers):
    """The process was killed after it had written the file; the checkpoint has the former relations."""
    flat.derive_all()
    before = state(flat)
    flat.checkpoint()
    shapes = WorldShapes.of({BOWL: solid(size_of(flat, BOWL))})
    body_shapes.write(handlers._file, shapes)
    assert body_shapes.load(handlers._file) == ""
    again = home.reopened(flat)
    again.derive_all()
    found = state(again)
    again._journal.close()
    model_shapes.exchange_world(WorldShapes())
    flat.exchange_shapes(shapes)
    assert found == state(flat) != before


def test_every_shape_of_the_flat_can_be_exchanged_with_asserted_locations(flat, handlers):
    (first, *_) = sorted(contents_after_start(flat))
    asserted = (v.iri(flat.entity(first).iri), v.dm("isInside"), v.iri(flat.entity(BOWL).iri))
    flat.commit(Transaction(id="said", source="operator", insert=(asserted,)))
    before = state(flat)
    bodies = [e.name for e in flat.entities() if not e.place and e.pose is not None and size_of(flat, e.name)]
    handlers.on_shapes(message(**{name: solid(size_of(flat, name)) for name in bodies}))
    assert flat.is_asserted(asserted)
    assert state(flat) != before
    flat.exchange_shapes(WorldShapes())
    assert state(flat) == before
    edit = Edit(name=first, at=(2.0, 2.0, 0.0))
    assert flat.commit(Transaction(id="moved", source="operator", verb="update", edit=(edit,)))


def contents_after_start(flat):
    flat.derive_all()
    return contents(flat)


def test_shapes_remain_for_a_start_without_the_simulator_and_repeated_ones_change_nothing(flat, handlers):
    sent = message(**{BOWL: solid(size_of(flat, BOWL))})
    assert handlers.on_shapes(sent).text == "shapes of 1 body"
    file, known = handlers._file, model_shapes.world()
    stamp = file.stat().st_mtime_ns
    handlers.on_shapes(sent)
    assert (file.stat().st_mtime_ns, len(handlers.told)) == (stamp, 1)
    model_shapes.exchange_world(WorldShapes())
    assert body_shapes.load(file) == ""
    assert model_shapes.world() == known


def test_shapes_of_bodies_that_are_not_in_the_map_yet_are_passed_on(flat, handlers):
    handlers.on_shapes(message(unknown1=solid((1.0, 1.0, 1.0))))
    assert handlers.told == [frozenset()]


def test_invalid_shapes_change_nothing(flat, handlers):
    nowhere = WorldShapes({}, {BOWL: ("world/none",)})
    unnamed = WorldShapes({}, {BOWL: ()})
    for content in (b"{", b"[]", msgspec.json.encode(nowhere), msgspec.json.encode(unnamed)):
        with pytest.raises(errors.BadRequest, match="shapes of the world's bodies are invalid"):
            handlers.on_shapes(ShapeBodies(content=content))
    assert model_shapes.world() == WorldShapes()
    assert not handlers._file.exists()


def test_shapes_that_cannot_be_stored_are_rejected_and_the_former_remain(flat, handlers):
    handlers.on_shapes(message(**{BOWL: solid(size_of(flat, BOWL))}))
    known, stored = model_shapes.world(), handlers._file.read_bytes()
    handlers._file.with_name(f"{handlers._file.name}.partly").mkdir()
    with pytest.raises(errors.Refused, match="cannot be written"):
        handlers.on_shapes(message(**{BOWL: structs.replace(solid(size_of(flat, BOWL)), surfaces=())}))
    assert (model_shapes.world(), handlers._file.read_bytes()) == (known, stored)


def test_an_unreadable_file_is_reported(tmp_path, monkeypatch):
    monkeypatch.setattr(model_shapes, "_world", WorldShapes())
    file = tmp_path / body_shapes.FILENAME
    assert body_shapes.load(file) == ""
    file.write_bytes(b"{")
    assert "cannot be read" in body_shapes.load(file)
    assert model_shapes.world() == WorldShapes()


def found(handlers, *keys):
    reply = handlers.on_shapes_of(ShapesOf(keys=keys))
    shapes = msgspec.json.decode(reply.content, type=WorldShapes)
    return {name: shapes.shapes[number] for name, (number,) in shapes.bodies.items()}


def test_shapes_are_those_of_the_world_then_of_models_at_their_size(handlers):
    handlers.on_shapes(message(block1=solid((0.4, 0.2, 0.1))))
    shapes = found(
        handlers,
        ShapeKey(name="block1", model="table"),
        ShapeKey(name="table9", model="table", size_m=(2.0, 1.0, 0.5)),
        ShapeKey(name="thing9", size_m=(0.1, 0.1, 0.1)),
        ShapeKey(name="unknown9"),
    )
    assert shapes["block1"].size_m == (0.4, 0.2, 0.1)
    assert shapes["table9"].size_m == (2.0, 1.0, 0.5)
    assert len(shapes["table9"].parts) > 1
    assert len(shapes["thing9"].parts) == 1
    assert "unknown9" not in shapes


def test_the_shape_of_an_open_fridge_has_its_door_open(handlers):
    shapes = found(
        handlers,
        ShapeKey(name="a", model="fridge"),
        ShapeKey(name="b", model="fridge", joints=(("isOpen", True),)),
        ShapeKey(name="c", model="fridge"),
    )
    assert shapes["a"].parts != shapes["b"].parts
    assert shapes["a"].parts == shapes["c"].parts
