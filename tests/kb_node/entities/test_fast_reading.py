"""Fast reading gives the same entities as reading them one by one."""

from itertools import count

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from semmap.nodes.kb_node.entities import entity_reading
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.entities import Pose
from tests.kb_node import home
from tests.kb_node.home import transaction

FLOAT = v.XSD_FLOAT


def star(name, position=(1.0, 2.0, 3.0), **fields):
    return entity_triples.describe(name, v.dm("Chair"), pose=Pose(position_m=position), **fields)


def node(name, kind):
    return v.entity_iri(f"{name}_{kind}")


def numbered(subject, predicates, texts):
    return [(subject, p, v.literal(text, FLOAT)) for p, text in zip(predicates, texts, strict=False)]


NUMBER = st.sampled_from(["0.5", "1.0", "2.5E0", "-1.0", "0.0"])
FAULTY = st.sampled_from(["1.0", "INF", "NaN", "1e30", "-1.0", "0.0"])


@st.composite
def pieces(draw):
    """Triples of an entity by shape, as a function of its name and numbers."""
    coordinates = draw(st.sampled_from([0, 2, 3, 3, 3]))
    orientation = draw(st.sampled_from([0, 0, 1, 4]))
    size = draw(st.sampled_from([0, 3, 3]))
    names = draw(st.integers(0, 2))
    alternatives = draw(st.integers(0, 3))
    extra = draw(st.sampled_from(["", "", "", "two positions", "shared", "conflict", "an IRI", "entity"]))
    late = draw(st.booleans())

    def triples(name, numbers):
        entity, at, extent = v.entity_iri(name), node(name, "coordinates"), node(name, "size")
        yield (entity, v.RDF_TYPE, v.dm("Chair"))
        if coordinates or orientation:
            yield (entity, v.HAS_POSITION, at)
            yield from numbered(at, v.COORDINATE_XYZ[:coordinates], numbers)
            yield from numbered(at, v.ORIENTATION_WXYZ[:orientation], ("0.6", "0.0", "0.0", "0.8"))
        if size:
            yield (entity, v.HAS_SIZE, extent)
            yield from numbered(extent, v.SIZE_XYZ, numbers)
        for i in range(names):
            yield (entity, v.HAS_PREFERRED_REFERENCE, node(name, f"p{i}"))
            yield (node(name, f"p{i}"), v.LEXICAL_REFERENCE, v.literal(f"{numbers[0]} {i}"))
        for i in reversed(range(alternatives)):
            yield (entity, v.HAS_ALTERNATIVE_REFERENCE, node(name, f"a{i}"))
            yield (node(name, f"a{i}"), v.LEXICAL_REFERENCE, v.literal(f"{-i}"))
        if extra == "two positions":
            yield (entity, v.HAS_POSITION, node(name, "coordinates2"))
            yield from numbered(node(name, "coordinates2"), v.COORDINATE_XYZ, "789")
        elif extra == "shared":
            yield (entity, v.HAS_ALTERNATIVE_REFERENCE, v.entity_iri("shared"))
        elif extra == "conflict":
            yield (entity, v.CONFLICTING_OBSERVATION, v.literal("a table"))
        elif extra == "an IRI":
            yield (at, v.COORDINATE_XYZ[0], node(name, "nowhere"))
        elif extra == "entity":
            yield (entity, v.dm("isOn"), node(name, "below"))
            yield (node(name, "below"), v.RDF_TYPE, v.dm("Chair"))

    def afterwards(name):
        return [(node(name, "p0"), v.LEXICAL_REFERENCE, v.literal("a late name"))] if late else []

    return triples, afterwards


ALIKE = {"shape": pieces(), "numbers": st.lists(st.tuples(NUMBER, NUMBER, FAULTY), min_size=2, max_size=4)}


@settings(max_examples=25, deadline=None, derandomize=True)
@given(**ALIKE)
def test_runs_of_one_shape_are_read_like_single_entities(tmp_path_factory, shape, numbers):
    check_alike(tmp_path_factory, shape, numbers)


@pytest.mark.long
@settings(max_examples=400, deadline=None)
@given(**ALIKE)
def test_many_runs_of_one_shape_are_read_like_single_entities(tmp_path_factory, shape, numbers):
    check_alike(tmp_path_factory, shape, numbers)


def check_alike(tmp_path_factory, shape, numbers):
    semantic_map = home.new_map(tmp_path_factory.mktemp("alike"))
    shared = (v.entity_iri("shared"), v.LEXICAL_REFERENCE, v.literal("of all"))
    semantic_map.commit(transaction("shared", [shared]))
    triples, afterwards = shape
    facts = [t for i, given in enumerate(numbers) for t in triples(f"e{i}", given)]
    facts += [t for i in range(len(numbers)) for t in afterwards(f"e{i}")]
    together = _said(lambda: semantic_map.commit(transaction("all", facts)).changed)
    semantic_map.reasoner.apply(insert=facts)
    assert together == _said(lambda: _each_by_itself(semantic_map))


def _each_by_itself(semantic_map):
    reasoner, classes = semantic_map.reasoner, semantic_map.classes
    for iri in sorted(reasoner.instances(v.dm("Chair"))):
        known = semantic_map.find_by_iri(iri)
        entity_reading.require_one_place(reasoner.about, classes, iri)  # as a commit does
        yield entity_reading.read_entity(
            reasoner, classes, iri, known.provenance if known else entity_reading._OF_THE_TBOX
        )


def _said(read):
    """Return the entities, or the error."""
    try:
        return list(read())
    except errors.BadRequest as error:
        return error.text


def test_the_usual_run_is_regular(semantic_map, monkeypatch):
    numbers = count()

    def usual(name):
        x = float(next(numbers))
        return star(
            name, (x, 0.0, 0.0), size_m=(1.0, 1.0, 1.0 + x), preferred=f"{x}", alternatives=("b", "a")
        )

    semantic_map.commit(transaction(1, usual("e0")))
    monkeypatch.delattr(entity_reading, "read_entity")
    semantic_map.commit(transaction(2, [*usual("e1"), *usual("e2")]))
    entity = semantic_map.entity("e2")
    assert (entity.pose.position_m, entity.size_m) == ((2.0, 0.0, 0.0), (1.0, 1.0, 3.0))
    assert (entity.preferred_reference, entity.alternative_references) == ("2.0", ("b", "a"))
    assert entity.class_ == "Chair"


def test_labels_are_read_alike(semantic_map, monkeypatch):
    def named(name):
        iri = v.entity_iri(name)
        label = (iri, v.RDFS_LABEL, v.literal(f"{name} it", lang="it"))
        return [*star(name), label, (iri, v.SKOS_ALT_LABEL, v.literal("b"))]

    semantic_map.commit(transaction(1, named("e0")))
    monkeypatch.delattr(entity_reading, "read_entity")
    semantic_map.commit(transaction(2, [*named("e1"), *named("e2")]))
    entity = semantic_map.entity("e2")
    assert (entity.preferred_reference, entity.alternative_references) == ("e2 it", ("b",))


def test_an_entity_of_a_known_shape_gets_a_name_by_the_same_rule(semantic_map):
    for name in ("e0", "e1", "1e"):
        semantic_map.commit(transaction(name, star(name)))
    assert semantic_map.entity("_1e").iri == v.bare(v.entity_iri("1e"))
