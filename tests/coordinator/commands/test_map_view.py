"""The coordinator's view of the map: other names and IRIs of entities."""

from __future__ import annotations

import pytest

from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.ontology import vocabulary as v
from semmap.schemas import commands as c
from semmap.schemas.commits import Departed, Effects, Snapshot
from semmap.schemas.entities import SAME_AS, Entity, Provenance

BY = Provenance(commit=1, stamp_ns=1, source="file")
PARTS = ("provenance", "pose_provenance", "shape_provenance", "reference_provenance")


def entity(name, *others, iri=None):
    properties = {SAME_AS: others} if others else {}
    said = dict.fromkeys(PARTS, BY)
    return Entity(
        name=name, class_="Cup", iri=iri or f"urn:{name}", types=("Cup",), properties=properties, **said
    )


@pytest.fixture
def view():
    made = MapView()
    bowl = entity("bowl1", iri=v.bare(v.entity_iri("bowl1")))
    made.begin(Snapshot(seq=1, entities=(entity("cup1", "mug"), entity("cup2"), bowl), digest="1"))
    return made


@pytest.mark.parametrize(
    ("command", "expected"),
    [
        (c.Set(name="mug", property="isOpen", values=(True,)), {"name": "cup1"}),
        (c.Remove(names=("cup2", "mug")), {"names": ("cup2", "cup1")}),
        (c.Remove(names=("urn:cup2", "<urn:cup1>", "x:cup1")), {"names": ("cup2", "cup1", "x:cup1")}),
        (c.Remove(names=(":bowl1", ":cup1", "bowl1")), {"names": ("bowl1", ":cup1", "bowl1")}),
        (c.WasWhen(name="mug", relation="isOn", other="urn:cup2"), {"name": "cup1", "other": "cup2"}),
        (c.WasWhen(name="mug", relation="isOpen"), {"name": "cup1", "other": True}),
        (c.FindWay(from_="urn:cup1", to="urn:cup2"), {"from_": "cup1", "to": "cup2"}),
        (c.Relations(name="mug", other="mug", viewer="mug"), {"other": "cup1", "viewer": "cup1"}),
        (c.Move(name="cup2", on="mug"), {"name": "cup2", "on": "cup1"}),
        (c.Attach(name="mug", to="cup2"), {"name": "cup1", "to": "cup2"}),
        (c.Rename(name="mug", new="cup3"), {"name": "cup1", "new": "cup3"}),
        (c.Add(class_="Cup", name="mug"), {"name": "mug"}),  # and so it is taken
        (c.Add(class_="Cup", name="mug", on="mug"), {"name": "mug", "on": "cup1"}),
        (c.Get(name="other"), {"name": "other"}),
        (c.Explain(name="mug", predicate="sameAs", value="cup1"), {"name": "mug"}),
    ],
)
def test_a_command_names_an_entity_by_any_of_its_names(view, command, expected):
    found = view.with_primary_names(command)
    assert {field: getattr(found, field) for field in expected} == expected


def test_the_changes_of_a_batch_name_entities_by_any_name(view):
    batch = c.Batch(changes=(c.Update(name="mug", ref="mine"), c.Update(name="cup2", ref="yours")))
    assert [change.name for change in view.with_primary_names(batch).changes] == ["cup1", "cup2"]


def test_another_name_of_an_entity_is_not_free(view):
    view.take(
        Effects(
            seq=2, digest="2", changed=(entity("cup1", "cup2", "mug"),),
            removed=(Departed(name="cup2", types=()),), id="2",
        )
    )  # fmt: skip
    assert view.free_name("Cup") == "cup3"


def test_the_names_follow_the_commits(view):
    view.take(Effects(seq=2, digest="2", changed=(entity("cup2", "beaker"),), id="2"))
    assert view.with_primary_names(c.Get(name="beaker")).name == "cup2"
    view.take(
        Effects(
            seq=3, digest="3", changed=(entity("cup1"),), removed=(Departed(name="cup2", types=()),),
            id="3",
        )
    )  # fmt: skip
    assert view.primary_names == {}
    assert view.with_primary_names(c.Get(name="mug")).name == "mug"


def test_a_name_of_the_map_takes_precedence(view):
    view.take(Effects(seq=2, digest="2", changed=(entity("mug"),), id="2"))
    assert view.with_primary_names(c.Get(name="mug")).name == "mug"
