"""Authority: which sources may change which facts."""

import pytest

from semmap.nodes.coordinator.access import authority
from semmap.schemas import commands as c
from semmap.schemas import errors
from tests.coordinator.commands.test_dispatcher import add

AT = (4.0, 5.0, 0.0)
SCENE = b'{"entities": [{"class": "Chair", "name": "new"}]}'
CHANGES = {
    "class": lambda d, s: d.change(c.Update(name="chair1", class_="Furniture", source=s)),
    "size": lambda d, s: d.change(c.Update(name="chair1", size=(1.0, 1.0, 1.0), source=s)),
    "reference": lambda d, s: d.change(c.Update(name="chair1", ref="stool", source=s)),
    "no references": lambda d, s: d.change(c.Update(name="chair1", alt=(), source=s)),
    "existence": lambda d, s: d.change(c.Remove(names=("chair1",), source=s)),
    "all existence": lambda d, s: d.change(c.Clear(source=s)),
    "another map": lambda d, s: d.change(c.Load(content=SCENE, filename="s.json", replace=True, source=s)),
}
changes = pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES.keys())


@changes
@pytest.mark.parametrize("source", ["scene", "perception"])
def test_facts_of_an_operator_are_changed_by_operators_only(dispatcher, source, change):
    add(dispatcher, name="chair1", alt=("seat",))
    before = dispatcher.map.entity("chair1")
    with pytest.raises(errors.Refused, match="chair1 was defined by an operator, so only an operator may"):
        change(dispatcher, source)
    assert dispatcher.map.entity("chair1") == before
    change(dispatcher, "operator")
    assert dispatcher.map.entities.get("chair1") != before


@pytest.mark.parametrize("source", ["scene", "perception"])
def test_every_source_may_change_the_pose(dispatcher, source):
    add(dispatcher, name="chair1")
    dispatcher.change(c.Update(name="chair1", at=AT, source=source, agent="camera", confidence=0.5))
    chair1 = dispatcher.map.entity("chair1")
    assert (chair1.pose.position_m, chair1.pose_provenance.source) == (AT, source)
    assert (chair1.pose_provenance.agent, chair1.pose_provenance.confidence) == ("camera", 0.5)


@changes
def test_perception_may_change_its_own_facts(dispatcher, change):
    add(dispatcher, name="chair1", alt=("seat",), source="perception")
    before = dispatcher.map.entity("chair1")
    change(dispatcher, "perception")
    assert dispatcher.map.entities.get("chair1") != before


@changes
def test_an_operator_may_claim_an_entity_of_perception(dispatcher, change):
    add(dispatcher, name="chair1", alt=("seat",), source="perception")
    dispatcher.change(c.Update(name="chair1", ref="my chair"))
    dispatcher.change(c.Update(name="chair1", at=AT, source="perception"))
    with pytest.raises(errors.Refused, match="only an operator may"):
        change(dispatcher, "perception")


def test_only_an_operator_replaces_the_tbox_or_undoes_what_an_operator_did(dispatcher):
    add(dispatcher, name="chair1")
    with pytest.raises(errors.Refused, match="only an operator may replace the TBox"):
        dispatcher.change(c.Load(content=b"x", tbox=True, source="perception"))
    with pytest.raises(errors.Refused, match="commit 1 was made by an operator"):
        dispatcher.change(c.Undo(source="perception"))
    with pytest.raises(errors.BadRequest, match="always replaces"):
        dispatcher.change(c.Load(content=b"x", tbox=True, replace=True))


def test_a_perceived_conflict_is_stored_with_the_entity(dispatcher, semantic_map):
    add(dispatcher, name="chair1", ref="seat")
    before = dispatcher.map.entity("chair1")
    dispatcher.change(
        c.Update(name="chair1", conflict="looks like a Cup", source="perception", confidence=0.9)
    )
    chair1 = dispatcher.map.entity("chair1")
    assert (chair1.conflict, chair1.provenance.source) == ("looks like a Cup", "perception")
    assert chair1.provenance.confidence == 0.9
    assert (chair1.class_, chair1.shape_provenance) == (before.class_, before.shape_provenance)
    assert (chair1.pose_provenance, chair1.reference_provenance) == (
        before.pose_provenance,
        before.reference_provenance,
    )
    dispatcher.change(c.Update(name="chair1", conflict="not seen", source="perception"))
    assert dispatcher.map.entity("chair1").conflict == "not seen"
    dispatcher.change(c.Update(name="chair1", conflict="", source="perception"))
    assert dispatcher.map.entity("chair1").conflict == ""
    assert not any("conflict" in triple[1] for triple in semantic_map.abox())


def test_a_conflict_goes_with_its_entity(dispatcher, semantic_map):
    add(dispatcher, name="chair1")
    dispatcher.change(c.Update(name="chair1", conflict="looks like a Cup", source="perception"))
    dispatcher.change(c.Remove(names=("chair1",)))
    assert semantic_map.abox() == []


def test_the_same_conflict_again_changes_nothing(dispatcher):
    add(dispatcher, name="chair1")
    dispatcher.change(c.Update(name="chair1", conflict="looks like a Cup", source="perception"))
    again = dispatcher.change(c.Update(name="chair1", conflict="looks like a Cup", source="perception"))
    assert again.commit is None


@pytest.mark.parametrize(
    ("command", "truth", "said"),
    [
        (c.Remove(names=("cup1",)), "scene", "is added again"),
        (c.Clear(), "perceived", "is added again"),
        (c.Remove(names=("cup1",)), "map", None),
        (c.Undo(), "scene", "bodies stay; to move one: semmap move"),
        (c.Undo(), "map", None),
        (c.Update(name="cup1", at=AT), "scene", "semmap move"),
        (c.Update(name="cup1", yaw=1.0), "scene", "semmap move"),
        (c.Update(name="cup1", ref="mug"), "scene", None),
        (c.Update(name="cup1", at=AT), "perceived", None),
        (c.Add(class_="Cup", at=AT), "scene", None),
    ],
)
def test_changes_that_will_be_overridden_get_a_note(command, truth, said):
    note = authority.describe_override(command, truth)
    assert (said is None and note is None) or said in note
