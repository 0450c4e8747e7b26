import pytest
from msgspec import structs

from semmap.nodes.kb_node.entities import entity_reading
from semmap.nodes.kb_node.entities.entity_reading import inherit_provenance
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commits import Edit, Transaction
from semmap.schemas.entities import Entity, Pose, Provenance
from tests.kb_node import home
from tests.kb_node.home import chair, transaction, turtle

CHAIR1 = v.entity_iri("chair1")


def entity_of(semantic_map, text):
    semantic_map.commit(transaction(text, turtle(f":a a dm:Chair . {text}")))
    return semantic_map.entity("a")


def positioned(x="1.0", y="2.0", z="3.0", more=""):
    return (
        f':a dm:hasPosition [ dm:float_coordinates_x "{x}"^^xsd:float ;'
        f' dm:float_coordinates_y "{y}"^^xsd:float ; dm:float_coordinates_z "{z}" {more} ] .'
    )


def turned(w, x, y, z):
    return "".join(
        f'; dm:float_orientation_{axis} "{value}"' for axis, value in zip("wxyz", (w, x, y, z), strict=True)
    )


def test_an_entity_is_read_back_as_written(semantic_map):
    pose = Pose(position_m=(1.5, -2.25, 0.0), orientation_wxyz=(0.6, 0.0, 0.0, 0.8))
    star = entity_triples.describe(
        "chair1",
        v.dm("Chair"),
        pose=pose,
        size_m=(0.5, 0.5, 1e-3),
        preferred='my\n"chair"',
        alternatives=("b", "a"),
    )
    (entity,) = semantic_map.commit(transaction(1, star)).changed
    assert (entity.pose, entity.size_m) == (pose, (0.5, 0.5, 1e-3))
    assert (entity.preferred_reference, entity.alternative_references) == ('my\n"chair"', ("b", "a"))
    assert (entity.model, entity.fixed, entity.place) == ("chair", False, False)


def test_missing_values_are_none(semantic_map):
    entity = entity_of(semantic_map, "")
    assert (entity.pose, entity.size_m, entity.preferred_reference) == (None, None, None)
    assert entity.alternative_references == ()


def test_an_incomplete_position_is_none_and_an_incomplete_orientation_is_identity(semantic_map):
    assert (
        entity_of(semantic_map, ':a dm:hasPosition [ dm:float_coordinates_x "1.0"^^xsd:float ] .').pose
        is None
    )
    semantic_map.commit(transaction(2, retract=semantic_map.abox()))
    entity = entity_of(semantic_map, positioned(more='; dm:float_orientation_w "0.5"'))
    assert entity.pose == Pose(position_m=(1.0, 2.0, 3.0))


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (positioned(y="NaN"), r"a: float_coordinates_y is NaN; it must be a number from -10000 to 10000"),
        (positioned(x="INF"), "a: float_coordinates_x is INF; it must be a number"),
        (positioned(x="1e300"), "a: float_coordinates_x is 1e300; it must be a number"),
        (positioned(z="here"), "a: float_coordinates_z is here; it must be a number"),
        (positioned(z="1e9"), "a: float_coordinates_z is 1e9; it must be a number"),
        (':a dm:hasSize [ dm:float_size_x :b ] .', "a: float_size_x is b; it must be a number"),
        (
            ":a dm:hasSize [ dm:float_size_x 1.0 ; dm:float_size_y 0.0 ; dm:float_size_z 1.0 ] .",
            r"a: the size \(1.0, 0.0, 1.0\) must be positive",
        ),
        (
            ":a dm:hasSize [ dm:float_size_x -1.0 ; dm:float_size_y 1.0 ; dm:float_size_z 1.0 ] .",
            r"a: the size \(-1.0, 1.0, 1.0\) must be positive",
        ),
        (positioned(more=turned(1, 1, 0, 0)), r"a: the quaternion .* has length 1.414; it must be 1"),
        (positioned(more=turned(2, 0, 0, "x")), "a: float_orientation_z is x; it must be a number"),
    ],
)  # fmt: skip
def test_an_invalid_entity_is_rejected(semantic_map, text, fault):
    with pytest.raises((errors.BadRequest, errors.Inconsistent), match=fault):
        entity_of(semantic_map, text)
    assert (len(semantic_map), semantic_map.seq) == (0, 0)


def test_a_label_that_is_not_text_is_ignored(semantic_map):
    assert (
        entity_of(
            semantic_map, ":a dm:hasPreferredReference [ dm:lexicalReference :b ] ."
        ).preferred_reference
        is None
    )


@pytest.mark.parametrize(
    ("iri", "fault"),
    [
        ("_:b", "a Chair is a blank node; an entity needs an IRI"),
        ("<javascript:x#chair>", "needs an IRI of http, https, urn or file"),
    ],
)
def test_an_entity_needs_a_name(semantic_map, iri, fault):
    with pytest.raises(errors.BadRequest, match=fault):
        semantic_map.commit(transaction(1, [(iri, v.RDF_TYPE, v.dm("Chair"))]))


@pytest.mark.parametrize(
    ("iri", "name"),
    [
        ("<http://a.org/x#1chair>", "_1chair"),
        ("<https://a.org/walls/9499a8c6-2e95-4531>", "_9499a8c6-2e95-4531"),
        ("<http://a.org/x#my%20chair>", "my_x20_chair"),
        ("<http://a.org/r/chair/>", "chair_x2F_"),
        ("<http://a.org/x#>", "x_x23_"),
        ("<http://dbpedia.org/resource/Mug_(cup)>", "Mug__x28_cup_x29_"),
    ],
)
def test_an_entity_whose_iri_does_not_end_in_a_name_is_found_by_one_and_keeps_its_iri(
    semantic_map, iri, name
):
    semantic_map.commit(transaction(1, [(iri, v.RDF_TYPE, v.dm("Chair"))]))
    assert [entity.name for entity in semantic_map.entities()] == [name]
    assert semantic_map.find_by_iri(iri) is semantic_map.entity(name)
    assert (iri, v.RDF_TYPE, v.dm("Chair")) in semantic_map.abox()
    semantic_map.commit(Transaction(id="2", source="file", edit=(Edit(name=name, ref="my chair"),)))
    assert semantic_map.entity(name).preferred_reference == "my chair"
    semantic_map.commit(Transaction(id="3", source="file", edit=(Edit(name=name, rename="chair7"),)))
    assert v.local_name(v.iri(semantic_map.entity("chair7").iri)) == "chair7"
    assert not [t for t in semantic_map.abox() if iri in t]


def test_two_iris_with_one_name_are_rejected(semantic_map):
    both = [(f"<http://a.org/x#{name}>", v.RDF_TYPE, v.dm("Chair")) for name in ("_1", "1")]
    with pytest.raises(errors.NameTaken) as raised:
        semantic_map.commit(transaction(1, both))
    assert raised.value.text == (
        "the name '_1' of <http://a.org/x#_1> is also that of <http://a.org/x#1>, and names are unique;"
        " give <http://a.org/x#_1> another last part"
    )


def test_the_value_of_a_property_is_the_name_of_its_entity(semantic_map):
    entity = entity_of(
        semantic_map, ":a a dm:Chair ; dm:isLocatedIn <http://a.org/r/1> . <http://a.org/r/1> a dm:Kitchen ."
    )
    assert entity.properties["isLocatedIn"] == ("_1",)


def test_the_most_specific_asserted_class_is_the_class_of_the_entity(semantic_map):
    entity = entity_of(semantic_map, ":a a dm:Object , dm:Seat .")
    assert (entity.class_, entity.model) == ("Chair", "chair")
    assert entity_of(semantic_map, ":a a dm:Door .").fixed


def test_of_two_positions_in_an_older_map_one_is_read_and_both_belong_to_the_entity(semantic_map):
    two = ":a dm:hasPosition :p2 , :p1 ." + "".join(
        f':p{i} dm:float_coordinates_x "{i}"^^xsd:float ;'
        " dm:float_coordinates_y 0 ; dm:float_coordinates_z 0 ."
        for i in (1, 2)
    )
    home.restated(semantic_map, 1, turtle(f":a a dm:Chair . {two}"))
    assert semantic_map.entity("a").pose == Pose(position_m=(1.0, 0.0, 0.0))
    (star,) = semantic_map.stars(["a"])
    assert {s for s, _, _ in star.own} == {v.entity_iri(n) for n in ("a", "p1", "p2")}


ORIGIN = "dm:float_coordinates_x '0'^^xsd:float ; dm:float_coordinates_y 0 ; dm:float_coordinates_z 0"


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        (f":a dm:hasPosition [ {ORIGIN} , 2 ] .", "a has two positions: (0, 0, 0) and (0, 0, 2); state one"),
        (
            f":a dm:hasPosition [ {ORIGIN} ] , [ {ORIGIN.replace('0', '3')} ] .",
            "a has two positions: (0, 0, 0) and (3, 3, 3); state one",
        ),
        (
            f":a dm:hasPosition [ {ORIGIN} {turned(1, 0, 0, 0)} {turned(0, 0, 0, 1)} ] .",
            "a has two orientations: (1, 0, 0, 0) and (1, 0, 0, 1); state one",
        ),
        (
            ":a dm:hasSize [ dm:float_size_x 1 ; dm:float_size_y 1 ; dm:float_size_z 1 , 2 ] .",
            "a has two sizes: (1, 1, 1) and (1, 1, 2); state one",
        ),
    ],
)
def test_two_poses_or_sizes_of_an_entity_are_rejected(semantic_map, text, complaint):
    before = home.state(semantic_map)
    with pytest.raises(errors.BadRequest) as rejected:
        entity_of(semantic_map, text)
    assert sorted(rejected.value.text.split()) == sorted(complaint.split()) or complaint.startswith(
        "a has 16"
    )
    assert home.state(semantic_map) == before


def test_a_second_pose_of_a_known_entity_is_rejected_but_the_same_pose_in_another_spelling_is_not(
    semantic_map,
):
    entity_of(semantic_map, f":a dm:hasPosition :p . :p {ORIGIN} .")
    same = f":a dm:hasPosition [ {ORIGIN.replace(' 0', ' 0.0e0')} ] ."
    semantic_map.commit(transaction("same", turtle(same)))
    with pytest.raises(errors.BadRequest, match="two positions"):
        semantic_map.commit(transaction("other", turtle(":p dm:float_coordinates_y 5 .")))
    assert semantic_map.entity("a").pose == Pose(position_m=(0.0, 0.0, 0.0))


SHARED = [(v.entity_iri(n), v.HAS_PREFERRED_REFERENCE, v.entity_iri("r")) for n in ("chair1", "chair2")]
REFERENCE = turtle(":r a dm:PreferredReference ; dm:lexicalReference 'chair' .")


def test_a_shared_label_belongs_to_no_entity_until_all_users_are_removed(semantic_map):
    semantic_map.commit(transaction(1, [*chair(), *chair("chair2"), *SHARED, *REFERENCE]))
    (one,) = semantic_map.stars(["chair1"])
    assert set(one.own) == {*chair(), SHARED[0]}
    both = semantic_map.stars(["chair1", "chair2"])
    assert set(REFERENCE) <= set(both[0].own)
    semantic_map.commit(transaction(2, retract=one.own))
    assert semantic_map.entity("chair2").preferred_reference == "chair"
    (other,) = semantic_map.stars(["chair2"])
    assert set(REFERENCE) <= set(other.own)
    semantic_map.commit(transaction(3, retract=other.own))
    assert semantic_map.abox() == []


def test_removing_two_entities_removes_what_they_share(semantic_map):
    semantic_map.commit(transaction(1, [*chair(), *chair("chair2"), *SHARED, *REFERENCE]))
    own = [t for star in semantic_map.stars(["chair1", "chair2"]) for t in star.own]
    semantic_map.commit(transaction(2, retract=own))
    assert semantic_map.abox() == []


def test_shared_coordinates_belong_to_no_entity(semantic_map):
    also = (v.entity_iri("chair2"), v.HAS_POSITION, v.entity_iri("chair1_coordinates"))
    is_one = (v.entity_iri("chair2"), v.RDF_TYPE, v.dm("Chair"))
    semantic_map.commit(transaction(1, [*chair(), also, is_one]))
    for star in semantic_map.stars(["chair1"]) + semantic_map.stars(["chair2"]):
        assert not any(s == v.entity_iri("chair1_coordinates") for s, _, _ in star.own)
    assert semantic_map.entity("chair1").pose == semantic_map.entity("chair2").pose is not None


def test_triples_that_refer_to_the_entity_are_incoming(semantic_map):
    said = turtle(":k dm:near :chair1 .")
    semantic_map.commit(transaction(1, [*chair(), *said]))
    (star,) = semantic_map.stars(["chair1"])
    assert star.incoming == said


def test_triples_of_the_tbox_belong_to_no_entity(tmp_path):
    semantic_map = home.new_map(tmp_path, [*home.TBOX, *REFERENCE])
    semantic_map.commit(transaction(1, [*chair(), SHARED[0]]))
    (star,) = semantic_map.stars(["chair1"])
    assert set(star.own) == {*chair(), SHARED[0]}
    home.close(semantic_map)


def test_owners_are_the_entity_and_those_that_refer_to_it(semantic_map):
    semantic_map.commit(transaction(1, chair()))
    node = v.entity_iri("chair1_coordinates")
    assert entity_reading.find_owners(semantic_map.reasoner, semantic_map.classes, node) == {node, CHAIR1}


SKOS = "http://www.w3.org/2004/02/skos/core#"


@pytest.mark.parametrize(
    ("text", "label", "aliases"),
    [
        ("rdfs:label 'mug'", "mug", ()),
        ("rdfs:label 'zeta fridge'@en , 'alpha frigo'@it", "zeta fridge", ("alpha frigo",)),
        ("rdfs:label 'zeta'@en-GB , 'alpha' , 'beta'@it", "zeta", ("alpha", "beta")),
        ("rdfs:label 'zeta' , 'alpha'@de", "zeta", ("alpha",)),
        (f"rdfs:label 'a' ; <{SKOS}prefLabel> 'b'@it ; <{SKOS}altLabel> 'c' , 'a'", "b", ("a", "c")),
        (f"<{SKOS}altLabel> 'c'", None, ("c",)),
        ("rdfs:label 'a' ; dm:hasPreferredReference [ dm:lexicalReference 'z' ]", "z", ("a",)),
        ("rdfs:label 'a' ; dm:hasPreferredReference [ dm:lexicalReference 'a' ]", "a", ()),
        ("rdfs:label 'a' ; dm:hasAlternativeReference [ dm:lexicalReference 'b' ]", "a", ("b",)),
    ],
)
def test_labels_of_every_language_are_references(semantic_map, text, label, aliases):
    entity = entity_of(semantic_map, f":a {text} .")
    assert (entity.preferred_reference, entity.alternative_references) == (label, aliases)


def test_new_aliases_replace_labels_and_a_new_label_does_not(semantic_map):
    def edit(number, **fields):
        edits = (Edit(name="a", **fields),)
        semantic_map.commit(Transaction(id=f"e{number}", source="operator", edit=edits))
        entity = semantic_map.entity("a")
        return entity.preferred_reference, entity.alternative_references

    entity_of(semantic_map, ":a rdfs:label 'fridge'@en , 'frigo'@it , 'frigorifero'@it .")
    assert edit(1, alt=("frigo", "icebox")) == ("fridge", ("icebox", "frigo"))
    assert edit(2, ref="big fridge") == ("big fridge", ("icebox", "fridge", "frigo"))
    assert edit(3, alt=()) == ("big fridge", ())


@pytest.mark.parametrize("alias", ["icebox", "frigo"])
def test_a_new_label_with_aliases_replaces_labels(semantic_map, alias):
    entity_of(semantic_map, ":a rdfs:label 'fridge'@en , 'frigo'@it .")
    edit = Edit(name="a", ref="big fridge", alt=(alias,))
    for number in range(2):  # the same again changes nothing
        semantic_map.commit(Transaction(id=f"e{number}", source="operator", edit=(edit,)))
        entity = semantic_map.entity("a")
        assert (entity.preferred_reference, entity.alternative_references) == ("big fridge", (alias,))


def test_another_name_of_an_entity_elsewhere_is_not_an_entity(semantic_map):
    link = turtle(":c owl:sameAs <http://dbpedia.org/resource/Mug_(cup)> .")
    semantic_map.commit(transaction(1, [*turtle(":c a dm:Chair ."), *link]))
    assert [entity.name for entity in semantic_map.entities()] == ["c"]
    semantic_map.commit(transaction(2, turtle("<http://dbpedia.org/resource/Mug_(cup)> a dm:Seat .")))
    assert [entity.name for entity in semantic_map.entities()] == ["c"]
    semantic_map.commit(transaction(3, turtle("<http://o.org/1> owl:sameAs :c .")))
    assert semantic_map.entity("c").other_names == ("Mug__x28_cup_x29_", "_1")
    semantic_map.commit(Transaction(id="4", source="file", remove=("c",)))
    assert not len(semantic_map)
    assert not semantic_map.abox()


BEFORE = Provenance(commit=1, stamp_ns=1, source="operator")
NOW = Provenance(commit=2, stamp_ns=2, source="file")
PARTS = (
    "provenance",
    "pose_provenance",
    "shape_provenance",
    "reference_provenance",
    "joint_provenance",
    "switch_provenance",
    "grip_provenance",
)


def with_provenance(said, **fields):
    described = {"name": "chair1", "class_": "Chair", "iri": "urn:chair1", "types": ("Chair",), **fields}
    return Entity(**described, **dict.fromkeys(PARTS, said))


@pytest.mark.parametrize(
    ("change", "part"),
    [
        ({"pose": Pose(position_m=(1.0, 0.0, 0.0))}, "pose_provenance"),
        ({"size_m": (1.0, 1.0, 1.0)}, "shape_provenance"),
        ({"model": "stool"}, "shape_provenance"),
        ({"fixed": True}, "shape_provenance"),
        ({"class_": "Stool"}, "shape_provenance"),
        ({"preferred_reference": "seat"}, "reference_provenance"),
        ({"alternative_references": ("seat",)}, "reference_provenance"),
        ({"properties": {"openness": 0.5}}, "joint_provenance"),
        ({"properties": {"isSwitchedOn": True}}, "switch_provenance"),
        ({"properties": {"isGraspedBy": "robot1"}}, "grip_provenance"),
        ({"properties": {"color": "red"}}, None),
        ({}, None),
    ],
)
def test_only_changed_parts_have_a_new_provenance(change, part):
    known, entity = with_provenance(BEFORE), with_provenance(NOW, **change)
    for concerned in (True, False):
        found = inherit_provenance(entity, known, concerned=concerned)
        expected = {name: NOW if name == part else BEFORE for name in PARTS}
        expected["provenance"] = NOW if concerned else BEFORE
        assert {name: getattr(found, name) for name in PARTS} == expected
        assert structs.replace(found, **dict.fromkeys(PARTS, NOW)) == entity


@pytest.mark.parametrize("part", PARTS[4:])
def test_the_provenance_of_a_state_ends_with_the_state(part):
    state = {"joint_provenance": "openness", "switch_provenance": "isSwitchedOn"}.get(part, "isGraspedBy")
    known = with_provenance(BEFORE, properties={state: 1.0})
    entity = structs.replace(with_provenance(NOW), **{part: None})
    assert getattr(inherit_provenance(entity, known, concerned=True), part) == NOW
