"""Edits of entities as changes of triples."""

import pytest

from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commits import Edit, NewEntity, Transaction
from semmap.schemas.entities import Pose, orientation_from_yaw
from tests.kb_node import home
from tests.kb_node.home import chair, transaction, turtle

TURNED = orientation_from_yaw(1.0)


def edited(semantic_map, **fields):
    """Commit an edit of `chair1`, or of the named entity."""
    edit = (Edit(**{"name": "chair1", **fields}),)
    return semantic_map.commit(
        Transaction(id=f"edited{fields}{semantic_map.seq}", source="operator", edit=edit)
    )


def added(semantic_map, name="chair1", **fields):
    """Commit a new chair."""
    new = (NewEntity(name=name, class_iri=v.bare(v.dm("Chair")), **fields),)
    return semantic_map.commit(Transaction(id=f"added {name}{semantic_map.seq}", source="operator", add=new))


def removed(semantic_map, *names):
    """Commit the removal of entities."""
    return semantic_map.commit(Transaction(id=f"removed{semantic_map.seq}", source="operator", remove=names))


def placed(semantic_map, **fields):
    """Commit a new position of `chair1`."""
    return edited(semantic_map, **fields)


def coordinates_of(semantic_map, name):
    edges = semantic_map.reasoner.asserted(v.entity_iri(name), v.HAS_POSITION)
    return [node for _, _, node in edges]


def test_values_that_are_not_given_are_kept(semantic_map):
    semantic_map.commit(transaction(1, chair()))
    placed(semantic_map, at=(1.0, 2.0, 3.0), yaw=1.0)
    assert semantic_map.entity("chair1").pose == Pose(position_m=(1.0, 2.0, 3.0), orientation_wxyz=TURNED)
    placed(semantic_map, at=(4.0, 5.0, 6.0))
    assert semantic_map.entity("chair1").pose == Pose(position_m=(4.0, 5.0, 6.0), orientation_wxyz=TURNED)
    placed(semantic_map, orientation=(1.0, 0.0, 0.0, 0.0))
    assert semantic_map.entity("chair1").pose == Pose(position_m=(4.0, 5.0, 6.0))


def test_coordinates_are_updated_in_place(semantic_map):
    semantic_map.commit(transaction(1, chair()))
    before = len(semantic_map.abox())
    nodes = coordinates_of(semantic_map, "chair1")
    placed(semantic_map, at=(7.0, 8.0, 9.0))
    assert (coordinates_of(semantic_map, "chair1"), len(semantic_map.abox())) == (nodes, before)


def test_shared_coordinates_are_kept_for_the_other_entity(semantic_map):
    shared = v.entity_iri("chair1_coordinates")
    other = [t for t in chair("chair2") if t[1] != v.HAS_POSITION and "coordinates" not in t[0]]
    both = [*chair(), *other, (v.entity_iri("chair2"), v.HAS_POSITION, shared)]
    semantic_map.commit(transaction(1, both))
    before = semantic_map.entity("chair2").pose
    placed(semantic_map, at=(7.0, 8.0, 9.0))
    assert semantic_map.entity("chair1").pose == Pose(position_m=(7.0, 8.0, 9.0))
    assert semantic_map.entity("chair2").pose == before
    assert coordinates_of(semantic_map, "chair1") == [v.entity_iri("chair1_coordinates_2")]


def test_a_first_position(semantic_map):
    semantic_map.commit(transaction(1, turtle(":chair1 a dm:Chair .")))
    with pytest.raises(errors.BadRequest, match="has no position; give one with --at"):
        placed(semantic_map, yaw=1.0)
    placed(semantic_map, at=(1.0, 2.0, 3.0))
    assert semantic_map.entity("chair1").pose == Pose(position_m=(1.0, 2.0, 3.0))


def test_the_same_pose_is_not_a_commit(semantic_map):
    semantic_map.commit(transaction(1, chair()))
    assert placed(semantic_map, at=semantic_map.entity("chair1").pose.position_m) is None


@pytest.mark.parametrize(
    ("fields", "error"),
    [
        ({"name": "chair9", "at": (0.0, 0.0, 0.0)}, errors.UnknownName),
        ({"orientation": (1.0, 1.0, 0.0, 0.0)}, errors.BadRequest),
        ({"yaw": 1.0, "orientation": (1.0, 0.0, 0.0, 0.0)}, errors.BadRequest),
    ],
)
def test_a_rejected_edit_changes_nothing(semantic_map, fields, error):
    semantic_map.commit(transaction(1, chair()))
    before = home.state(semantic_map)
    with pytest.raises(error):
        placed(semantic_map, **fields)
    assert home.state(semantic_map) == before


def test_entities_of_the_tbox_cannot_be_placed(tmp_path):
    throne = [(v.entity_iri("chair1"), v.RDF_TYPE, v.dm("Chair"))]
    throne += entity_triples.position(
        *map(v.entity_iri, ("chair1", "spot")), Pose(position_m=(0.0, 0.0, 0.0))
    )
    semantic_map = home.new_map(tmp_path, [*home.TBOX, *throne])
    with pytest.raises(errors.Refused, match="TBox"):
        placed(semantic_map, at=(1.0, 0.0, 0.0))
    home.close(semantic_map)


WHOLE = {
    "pose": Pose(position_m=(1.0, 2.0, 0.0), orientation_wxyz=TURNED),
    "size": (0.5, 0.5, 1.0),
    "ref": "seat",
    "alt": ("stool", "throne"),
}


def nodes_of(semantic_map, name, edge):
    return sorted(o for _, _, o in semantic_map.reasoner.asserted(v.entity_iri(name), edge))


def test_a_new_entity_has_all_its_triples(semantic_map):
    made = added(semantic_map, **WHOLE)
    assert set(made.inserted) == set(
        entity_triples.describe(
            "chair1",
            v.dm("Chair"),
            pose=WHOLE["pose"],
            size_m=WHOLE["size"],
            preferred="seat",
            alternatives=("stool", "throne"),
        )
    )
    assert made.retracted == ()
    with pytest.raises(errors.NameTaken, match="semmap get chair1"):
        added(semantic_map, "chair1")


def test_two_entities_with_the_same_name_in_one_transaction_are_rejected(semantic_map):
    new = NewEntity(name="chair1", class_iri=v.bare(v.dm("Chair")))
    with pytest.raises(errors.NameTaken):
        semantic_map.commit(Transaction(id="two", source="operator", add=(new, new)))
    assert len(semantic_map) == 0


@pytest.mark.parametrize("name", ["Color", "Coordinates"])
def test_a_class_that_is_not_spatial_is_rejected(semantic_map, name):
    new = NewEntity(name="x", class_iri=v.bare(v.dm(name)))
    with pytest.raises(errors.UnknownClass, match=name):
        semantic_map.commit(Transaction(id="1", source="operator", add=(new,)))
    added(semantic_map)
    with pytest.raises(errors.UnknownClass, match=name):
        edited(semantic_map, class_iri=v.bare(v.dm(name)))


def test_a_name_that_is_only_referred_to_can_be_used(semantic_map):
    semantic_map.commit(transaction(1, turtle(":chair2 a dm:Chair ; dm:touches :chair1 .")))
    added(semantic_map, **WHOLE)
    assert semantic_map.entity("chair1").preferred_reference == "seat"


def test_nodes_get_other_names_if_theirs_are_in_use(semantic_map):
    added(semantic_map, "chair1_size")
    semantic_map.commit(
        transaction(1, turtle(':x dm:lexicalReference "x" ; dm:touches :chair1_coordinates .'))
    )
    added(semantic_map, **WHOLE)
    chair1 = semantic_map.entity("chair1")
    assert (chair1.pose, chair1.size_m, chair1.preferred_reference) == (
        WHOLE["pose"],
        WHOLE["size"],
        "seat",
    )
    assert nodes_of(semantic_map, "chair1", v.HAS_SIZE) == [v.entity_iri("chair1_size_2")]
    assert semantic_map.entity("chair1_size").pose is None


def test_an_edit_contains_only_the_differences(semantic_map):
    added(semantic_map, **WHOLE)
    said = edited(semantic_map, ref="bench", alt=("stool", "perch"), size=(0.5, 0.5, 0.9))
    assert sorted(v.lexical(o) for _, _, o in said.retracted) == ["1.0", "seat", "throne"]
    assert sorted(v.lexical(o) for _, _, o in said.inserted) == ["0.9", "bench", "perch"]
    chair1 = semantic_map.entity("chair1")
    assert (chair1.preferred_reference, chair1.alternative_references) == ("bench", ("stool", "perch"))
    assert (chair1.size_m, chair1.pose) == ((0.5, 0.5, 0.9), WHOLE["pose"])


@pytest.mark.parametrize("texts", [(), ("a",), ("c", "b", "a"), tuple("abcdefg")])
def test_aliases_are_replaced_in_their_order(semantic_map, texts):
    added(semantic_map, **WHOLE)
    bare = len(semantic_map.abox()) - 2 * 3
    edited(semantic_map, alt=texts)
    assert semantic_map.entity("chair1").alternative_references == texts
    assert len(semantic_map.abox()) == bare + 3 * len(texts)
    edited(semantic_map, alt=("stool", "throne"))
    assert semantic_map.entity("chair1").alternative_references == ("stool", "throne")
    assert len(semantic_map.abox()) == bare + 6


def test_a_shared_label_is_kept_for_the_other_entity(semantic_map):
    added(semantic_map, "chair1", ref="seat")
    added(semantic_map, "chair2")
    shared = nodes_of(semantic_map, "chair1", v.HAS_PREFERRED_REFERENCE)
    edge = (v.entity_iri("chair2"), v.HAS_PREFERRED_REFERENCE, shared[0])
    semantic_map.commit(transaction(1, [edge]))
    edited(semantic_map, ref="mine")
    assert semantic_map.entity("chair1").preferred_reference == "mine"
    assert semantic_map.entity("chair2").preferred_reference == "seat"
    edited(semantic_map, name="chair2", ref="hers")
    assert semantic_map.entity("chair2").preferred_reference == "hers"
    assert len(semantic_map.abox()) == 2 * 4


def test_a_label_that_is_also_an_alias_stays_an_alias(semantic_map):
    added(semantic_map, ref="seat")
    (node,) = nodes_of(semantic_map, "chair1", v.HAS_PREFERRED_REFERENCE)
    semantic_map.commit(transaction(1, [(v.entity_iri("chair1"), v.HAS_ALTERNATIVE_REFERENCE, node)]))
    edited(semantic_map, ref="bench")
    chair1 = semantic_map.entity("chair1")
    assert (chair1.preferred_reference, chair1.alternative_references) == ("bench", ("seat",))


def test_several_sizes_become_one(semantic_map):
    added(semantic_map, size=(1.0, 1.0, 1.0))
    other = entity_triples.size(v.entity_iri("chair1"), v.entity_iri("other"), (2.0, 2.0, 2.0))
    home.restated(semantic_map, 1, other)
    edited(semantic_map, size=(3.0, 3.0, 3.0))
    assert semantic_map.entity("chair1").size_m == (3.0, 3.0, 3.0)
    assert len(semantic_map.abox()) == 1 + 5


def test_a_new_class_replaces_the_previous_one(semantic_map):
    added(semantic_map)
    edited(semantic_map, class_iri=v.bare(v.dm("Seat")))
    assert semantic_map.entity("chair1").class_ == "Seat"
    assert len(semantic_map.abox()) == 1


def test_an_entity_without_an_asserted_class_gets_one(semantic_map):
    triples = [t for t in chair() if t[1] != v.RDF_TYPE or t[0] != v.entity_iri("chair1")]
    semantic_map.commit(transaction(1, triples))
    assert semantic_map.entity("chair1").class_ == "Physical_Thing"
    edited(semantic_map, class_iri=v.bare(v.dm("Chair")))
    assert semantic_map.entity("chair1").class_ == "Chair"


def test_a_conflict_is_set_and_cleared(semantic_map):
    added(semantic_map)
    edited(semantic_map, conflict="it is a table")
    assert semantic_map.entity("chair1").conflict == "it is a table"
    edited(semantic_map, conflict="")
    assert semantic_map.entity("chair1").conflict == ""
    assert edited(semantic_map, conflict="") is None


def test_names_of_removed_entities_can_be_used_again(semantic_map):
    added(semantic_map, **WHOLE)
    added(semantic_map, "chair2")
    semantic_map.commit(transaction(1, turtle(":chair2 dm:touches :chair1 .")))
    again = Transaction(
        id="replace",
        source="operator",
        remove=("chair1",),
        add=(NewEntity(name="chair1", class_iri=v.bare(v.dm("Seat")), ref="seat"),),
    )
    semantic_map.commit(again)
    assert nodes_of(semantic_map, "chair1", v.HAS_PREFERRED_REFERENCE) == [
        v.entity_iri("chair1_preferred_reference")
    ]
    assert semantic_map.entity("chair1").class_ == "Seat"
    removed(semantic_map, "chair1", "chair2")
    assert semantic_map.abox() == []


def test_removing_an_unknown_entity_is_rejected(semantic_map):
    added(semantic_map)
    with pytest.raises(errors.UnknownName, match="chair9"):
        removed(semantic_map, "chair1", "chair9")
    assert len(semantic_map) == 1


def test_a_rename_rewrites_every_triple_with_the_old_iri(semantic_map):
    old, new = v.entity_iri("chair1"), v.entity_iri("throne")
    beside = (v.entity_iri("chair2"), v.dm("isBeside"), old)
    semantic_map.commit(transaction(1, [*chair(), *chair("chair2"), beside]))
    before = set(semantic_map.abox())
    entity = semantic_map.entity("chair1")
    commit = edited(semantic_map, rename="throne")
    swapped = {tuple(new if term == old else term for term in triple) for triple in before}
    assert set(semantic_map.abox()) == swapped
    assert {t for t in before if old in t} == set(commit.retracted)
    assert [gone.name for gone in commit.removed] == ["chair1"]
    assert {changed.name for changed in commit.changed} == {"throne", "chair2"}
    renamed = semantic_map.entity("throne")
    assert (renamed.pose, renamed.size_m, renamed.class_) == (entity.pose, entity.size_m, entity.class_)
    assert semantic_map.is_asserted((*beside[:2], new))


def test_a_rename_keeps_the_namespace_of_the_iri(semantic_map):
    named = v.iri("http://example.org/site#chair1")
    own = v.entity_iri("chair1")
    semantic_map.commit(transaction(1, [tuple(named if t == own else t for t in row) for row in chair()]))
    edited(semantic_map, rename="throne")
    assert semantic_map.entity("throne").iri == "http://example.org/site#throne"


def test_the_names_of_entities_and_of_their_nodes_are_taken(semantic_map):
    semantic_map.commit(transaction(1, [*chair(), *chair("chair2")]))
    with pytest.raises(errors.NameTaken, match="the name 'chair2' is taken; see: semmap get chair2"):
        edited(semantic_map, rename="chair2")
    with pytest.raises(errors.NameTaken, match="an individual that is not an entity; use another name"):
        edited(semantic_map, rename="chair2_coordinates")
    assert edited(semantic_map, rename="chair1") is None
