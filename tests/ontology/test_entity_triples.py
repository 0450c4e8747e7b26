from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import Pose

CHAIR = v.entity_iri("chair1")
POSE = Pose(position_m=(1.0, -2.5, 1e-7))
TURNED = Pose(position_m=(0.0, 0.0, 0.0), orientation_wxyz=(0.6, 0.0, 0.0, 0.8))


def test_only_what_is_given_is_said():
    assert entity_triples.describe("chair1", v.dm("Chair")) == [(CHAIR, v.RDF_TYPE, v.dm("Chair"))]


def test_what_describes_an_entity_is_named_after_it():
    triples = entity_triples.describe(
        "chair1", v.dm("Chair"), pose=POSE, size_m=(1.0, 1.0, 1.0), preferred="a b", alternatives=("c", "c")
    )
    assert {v.local_name(s) for s, _, _ in triples} == {
        "chair1",
        "chair1_coordinates",
        "chair1_size",
        "chair1_preferred_reference",
        "chair1_alternative_reference_1",
        "chair1_alternative_reference_2",
    }
    assert len(triples) == len(set(triples)) == 20


def test_a_suffix_ends_the_names_of_what_describes_it():
    triples = entity_triples.describe("chair1", v.dm("Chair"), pose=POSE, suffix="_7")
    assert {s for s, _, _ in triples} == {CHAIR, v.entity_iri("chair1_coordinates_7")}


def test_numbers_are_floats_that_lose_nothing():
    numbers = [
        v.lexical(o) for _, p, o in entity_triples.position(CHAIR, "_:c", POSE) if p in v.COORDINATE_XYZ
    ]
    assert [float(text) for text in numbers] == [1.0, -2.5, 1e-7]
    assert all(
        v.datatype_of(o) == v.XSD_FLOAT for _, _, o in entity_triples.size(CHAIR, "_:s", (1, 2, 3))[2:]
    )


def test_orientation_is_said_unless_it_is_the_identity():
    said = {p for _, p, _ in entity_triples.position(CHAIR, "_:c", TURNED)}
    assert set(v.ORIENTATION_WXYZ) <= said
    assert {p for _, p, _ in entity_triples.position(CHAIR, "_:c", POSE)}.isdisjoint(v.ORIENTATION_WXYZ)
