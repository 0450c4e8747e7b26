import math
import re
from dataclasses import dataclass
from itertools import combinations

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray
from rdflib import OWL, RDF, XSD, Graph, URIRef

from benchmarks.relations.accuracy import FLAT_BY_HAND
from semmap.ontology import EMPTY_WORLD, FLAT_WORLD, vocabulary
from tests.ontology.graphs import DM, MAP, local, named, read, superclasses

SINK_RIM_M = 0.85
"""The rim of sink1, over which its tap rises."""
TOUCHING_M = 0.001
NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_.-]{0,127}")


@dataclass(frozen=True)
class Block:
    """An upright box in the map frame [m, rad]."""

    name: str
    bottom: NDArray[np.float64]
    yaw: float
    size: NDArray[np.float64]

    @property
    def top_m(self) -> float:
        return float(self.bottom[2] + self.size[2])

    def corners(self) -> NDArray[np.float64]:
        """Footprint: (4, 2)."""
        half = self.size[:2] / 2
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        signs = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
        return self.bottom[:2] + (signs * half) @ np.array([[c, s], [-s, c]])

    def overlaps(self, other: "Block") -> bool:
        low, high = max(self.bottom[2], other.bottom[2]), min(self.top_m, other.top_m)
        if high - low <= TOUCHING_M:
            return False
        a, b = self.corners(), other.corners()
        for angle in (self.yaw, self.yaw + math.pi / 2, other.yaw, other.yaw + math.pi / 2):
            axis = np.array([math.cos(angle), math.sin(angle)])
            gap = max((a @ axis).min() - (b @ axis).max(), (b @ axis).min() - (a @ axis).max())
            if gap >= -TOUCHING_M:
                return False
        return True


def floats(graph: Graph, subject: URIRef, prefix: str, axes: str) -> NDArray[np.float64]:
    """The literals prefix_axis of a subject, each exactly once and an xsd:float."""
    values = []
    for axis in axes:
        (literal,) = graph.objects(subject, named(f"{prefix}_{axis}"))
        assert literal.datatype == XSD.float, (subject, axis)
        values.append(float(literal))
    return np.array(values)


def orientation(graph: Graph, coordinates: URIRef) -> NDArray[np.float64]:
    if (coordinates, DM.float_orientation_w, None) not in graph:
        return np.array([1.0, 0.0, 0.0, 0.0])
    return floats(graph, coordinates, "float_orientation", "wxyz")


def block(graph: Graph, entity: URIRef) -> Block:
    (coordinates,) = graph.objects(entity, DM.hasPosition)
    (size,) = graph.objects(entity, DM.hasSize)
    w, _, _, z = orientation(graph, coordinates)
    return Block(
        local(entity),
        floats(graph, coordinates, "float_coordinates", "xyz"),
        2 * math.atan2(z, w),
        floats(graph, size, "float_size", "xyz"),
    )


def walls() -> list[Block]:
    model = mujoco.MjModel.from_xml_path(str(FLAT_WORLD))
    boxes = [i for i in range(model.ngeom) if model.geom_type[i] == mujoco.mjtGeom.mjGEOM_BOX]
    return [
        Block(
            model.geom(i).name,
            model.geom_pos[i] - np.array([0, 0, model.geom_size[i][2]]),
            0.0,
            2 * model.geom_size[i],
        )
        for i in boxes
    ]


@pytest.fixture(scope="module")
def entities(flat: Graph) -> set[URIRef]:
    return set(flat.subjects(DM.hasPosition, None))


@pytest.fixture(scope="module")
def places(flat: Graph, tbox: Graph, entities: set[URIRef]) -> set[URIRef]:
    return {e for e in entities if DM.Location in superclasses(tbox, flat.value(e, RDF.type))}


@pytest.fixture(scope="module")
def blocks(flat: Graph, entities: set[URIRef], places: set[URIRef]) -> dict[str, Block]:
    """What is spawned, by name."""
    return {local(e): block(flat, e) for e in entities - places}


@pytest.fixture(scope="module")
def by_hand() -> Graph:
    """Where things are, as a person wrote it down."""
    return read(FLAT_BY_HAND)


def test_header_imports_the_tbox(flat: Graph) -> None:
    (ontology,) = flat.subjects(RDF.type, OWL.Ontology)
    assert f"<{ontology}>" == vocabulary.ABOX_ONTOLOGY
    assert [f"<{i}>" for i in flat.objects(ontology, OWL.imports)] == [vocabulary.TBOX_ONTOLOGY]


def test_enough_entities_in_enough_places(blocks: dict[str, Block], places: set[URIRef]) -> None:
    assert len(blocks) >= 45
    assert len(places) >= 9


def test_every_entity_is_a_whole_star(flat: Graph, tbox: Graph, entities: set[URIRef]) -> None:
    for entity in entities:
        assert str(entity).startswith(str(MAP))
        assert NAME.fullmatch(local(entity))
        (cls,) = flat.objects(entity, RDF.type)
        assert DM.Physical_Thing in superclasses(tbox, cls), entity
        (coordinates,) = flat.objects(entity, DM.hasPosition)
        (size,) = flat.objects(entity, DM.hasSize)
        assert (coordinates, RDF.type, DM.Coordinates) in flat
        assert (size, RDF.type, named("3Three_Dim_Size")) in flat
        assert min(floats(flat, size, "float_size", "xyz")) > 0
        assert math.isclose(np.linalg.norm(orientation(flat, coordinates)), 1.0, abs_tol=1e-6)
        (preferred,) = flat.objects(entity, DM.hasPreferredReference)
        assert (preferred, RDF.type, DM.PreferredReference) in flat
        for alternative in flat.objects(entity, DM.hasAlternativeReference):
            assert (alternative, RDF.type, DM.AlternativeReference) in flat
        for reference in (preferred, *flat.objects(entity, DM.hasAlternativeReference)):
            (text,) = flat.objects(reference, DM.lexicalReference)
            assert str(text).strip()


def test_nothing_is_described_that_belongs_to_no_entity(flat: Graph, entities: set[URIRef]) -> None:
    links = (DM.hasPosition, DM.hasSize, DM.hasPreferredReference, DM.hasAlternativeReference)
    owned = {o for link in links for o in flat.objects(None, link)}
    assert {s for s in flat.subjects() if str(s).startswith(str(MAP))} == entities | owned


def test_references_some_shared_some_alternative(flat: Graph) -> None:
    chairs = set(flat.subjects(RDF.type, DM.Chair))
    assert len({flat.value(c, DM.hasPreferredReference) for c in chairs}) < len(chairs)
    assert len(set(flat.subjects(DM.hasAlternativeReference, None))) > 20


def test_every_term_of_the_tbox_that_is_used_is_declared(flat: Graph, tbox: Graph) -> None:
    used = {t for triple in flat for t in triple if str(t).startswith(str(DM))}
    assert used <= set(tbox.subjects(RDF.type, None))


def test_nothing_overlaps(by_hand: Graph, blocks: dict[str, Block]) -> None:
    inside = {frozenset((local(s), local(o))) for s, o in by_hand.subject_objects(DM.isInside)}
    inside.add(frozenset(("tap1", "sink1")))  # a sink's box is as tall as the tap that its model has
    clashes = [
        (a.name, b.name)
        for a, b in combinations([*blocks.values(), *walls()], 2)
        if a.overlaps(b) and frozenset((a.name, b.name)) not in inside and not is_wall_joint(a, b, blocks)
    ]
    assert clashes == []


def is_wall_joint(a: Block, b: Block, blocks: dict[str, Block]) -> bool:
    return a.name not in blocks and b.name not in blocks


def test_what_stands_on_something_stands_on_its_top(by_hand: Graph, blocks: dict[str, Block]) -> None:
    pairs = [(blocks[local(s)], blocks[local(o)]) for s, o in by_hand.subject_objects(DM.isOn)]
    assert len(pairs) > 15
    for thing, support in pairs:
        top_m = SINK_RIM_M if support.name == "sink1" else support.top_m
        assert thing.bottom[2] == pytest.approx(top_m, abs=1e-6), thing.name
        assert np.all(np.abs(thing.bottom[:2] - support.bottom[:2]) < max(support.size[:2]) / 2), thing.name


def test_what_is_neither_on_nor_in_anything_stands_on_the_floor_or_is_fixed(
    flat: Graph, by_hand: Graph, tbox: Graph, blocks: dict[str, Block]
) -> None:
    for name, thing in blocks.items():
        if thing.bottom[2] == 0 or any(by_hand.objects(MAP[name], DM.isOn | DM.isInside)):
            continue
        ancestors = superclasses(tbox, flat.value(MAP[name], RDF.type))
        assert any((c, DM.fixed, None) in tbox for c in ancestors), name


def test_things_are_within_the_place_they_are_said_to_be_in(
    flat: Graph, by_hand: Graph, blocks: dict[str, Block]
) -> None:
    located = [(s, o) for s, o in by_hand.subject_objects(DM.isLocatedIn) if local(s) in blocks]
    assert len(located) > 30
    for thing, place in located:
        room = block(flat, place)
        off = np.abs(blocks[local(thing)].bottom[:2] - room.bottom[:2])
        assert np.all(off <= room.size[:2] / 2), (thing, place)


def test_the_floor_where_new_things_go_is_free(blocks: dict[str, Block]) -> None:
    disc = [
        Block("disc", np.array([2.0, 2.0, 0.0]), a, np.array([1.4, 1.4, 2.0])) for a in np.arange(0, 1.6, 0.1)
    ]
    assert [b.name for b in blocks.values() if any(d.overlaps(b) for d in disc)] == []


def test_each_door_fills_a_gap(blocks: dict[str, Block]) -> None:
    doors = [b for name, b in blocks.items() if name.startswith("door")]
    assert len(doors) == 7
    for door in doors:
        above = Block(
            "lintel", door.bottom + np.array([0, 0, door.size[2]]), door.yaw, np.array([0.06, 0.8, 0.1])
        )
        assert any(above.overlaps(w) and "over" in w.name for w in walls()), door.name


def test_the_overlap_test_sees_turned_boxes() -> None:
    wide = Block("a", np.zeros(3), 0.0, np.array([2.0, 0.2, 1.0]))
    turned = Block("b", np.array([0.0, 0.8, 0.0]), math.pi / 2, np.array([2.0, 0.2, 1.0]))
    slanted = Block("c", np.array([0.0, 0.8, 0.0]), math.pi / 4, np.array([0.9, 0.9, 1.0]))
    above = Block("d", np.array([0.0, 0.0, 1.0]), 0.0, np.array([1.0, 1.0, 1.0]))
    assert wide.overlaps(turned)
    assert not Block("e", np.array([0.0, 0.8, 0.0]), 0.0, turned.size).overlaps(wide)
    assert not slanted.overlaps(wide)
    assert not above.overlaps(wide)


@pytest.mark.parametrize(
    ("path", "cameras"), [(FLAT_WORLD, {"overview", "living", "kitchen"}), (EMPTY_WORLD, {"overview"})]
)
def test_worlds_compile_and_hold_no_body(path, cameras) -> None:
    model = mujoco.MjSpec.from_file(str(path)).compile()
    assert model.nbody == 1
    assert model.nlight >= 1
    assert {model.camera(i).name for i in range(model.ncam)} == cameras


def test_the_overview_sees_the_whole_flat() -> None:
    model = mujoco.MjModel.from_xml_path(str(FLAT_WORLD))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    camera = model.camera("overview").id
    top_m = 2.5
    corners = np.array([[x, y, top_m] for x in (-0.1, 10.1) for y in (-0.1, 8.1)])
    seen = (corners - data.cam_xpos[camera]) @ data.cam_xmat[camera].reshape(3, 3)
    half_height = np.tan(np.radians(model.cam_fovy[camera]) / 2)
    assert np.all(np.abs(seen[:, 1] / -seen[:, 2]) < half_height)
    assert np.all(np.abs(seen[:, 0] / -seen[:, 2]) < half_height * 4 / 3)
