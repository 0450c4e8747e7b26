"""Commits are possible while facts are derived in steps after a start."""

from __future__ import annotations

import random

import pytest

from semmap.nodes.kb_node import derived_facts, map_state
from semmap.nodes.kb_node.relations.facts import place_facts
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.measuring import crowds
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commits import Edit, NewEntity, Transaction
from semmap.schemas.entities import Pose


@pytest.fixture
def restarted(flat, monkeypatch):
    """The flat with many more objects, just started; deriving its facts takes many steps."""
    for module in (derived_facts, map_state, place_facts):
        monkeypatch.setattr(module, "_STEP", 3)
    monkeypatch.setattr(crowds, "MOST", 12)
    dice = random.Random(7)
    more = [new(flat, f"more{i}", at(flat, dice)) for i in range(30)]
    crowd = [new(flat, f"crowded{i}", (8.0, 2.0 + 0.001 * i, 0.0)) for i in range(crowds.MOST)]
    flat.commit(Transaction(id="more", source="file", add=(*more, *crowd)))
    flat.checkpoint()
    flat._journal.close()
    made = SemanticMap(Journal(flat._journal.path))
    yield made
    made._journal.close()


def new(semantic_map, name, position_m):
    return NewEntity(
        name=name,
        class_iri=v.bare(semantic_map.classes.iris["Cup"]),
        pose=Pose(position_m=position_m),
        size=(0.1, 0.1, 0.1),
    )


def at(semantic_map, dice):
    """Return a position on top of an entity, or near it."""
    other = semantic_map.entity(dice.choice(sorted(semantic_map.names)))
    x, y, z = other.pose.position_m if other.pose is not None else (1.0, 1.0, 0.0)
    return (x, y, z + (other.size_m or (0.0, 0.0, 0.1))[2])


def begin(semantic_map, steps=0):
    while not semantic_map.derives_at_commits:
        semantic_map.derive_some()
    for _ in range(steps):
        semantic_map.derive_some()


def agrees(semantic_map):
    """Return whether the facts equal those computed from the poses from scratch."""
    facts = Facts(semantic_map.classes.limits)
    facts.update(semantic_map.by_name.values())
    expected = {(v.entity_iri(s), v.dm(p), v.entity_iri(o)) for s, p, o in facts}
    assert set(semantic_map.derived_facts.computed.facts) == set(facts)
    return set(semantic_map.reasoner.computed()) == expected - semantic_map.derived_facts.suppressed.keys()


@pytest.mark.parametrize("seed", range(4))
def test_commits_between_the_steps_do_not_change_the_result(restarted, seed):
    dice = random.Random(seed)
    begin(restarted)
    for i in range(20):
        for _ in range(dice.randrange(3)):
            restarted.derive_some()
        if dice.random() < 0.3:
            add = (new(restarted, f"new{i}", at(restarted, dice)),)
            restarted.commit(Transaction(id=f"t{i}", source="operator", add=add))
        else:
            name = dice.choice([e.name for e in restarted.entities() if not e.place])
            edit = (Edit(name=name, at=at(restarted, dice)),)
            restarted.commit(Transaction(id=f"t{i}", source="operator", edit=edit))
    restarted.derive_all()
    assert agrees(restarted)


def test_computed_facts_of_a_commit_hold_immediately(restarted):
    begin(restarted)
    cup, table = restarted.entity("more1"), restarted.entity("more3")
    x, y, z = table.pose.position_m
    edit = (Edit(name=cup.name, at=(x, y, z + table.size_m[2])),)
    restarted.commit(Transaction(id="on", source="operator", edit=edit))
    assert restarted.reasoner.is_computed((v.entity_iri("more1"), v.dm("isOn"), v.entity_iri("more3")))
    assert not restarted._derived_all


def test_a_rejected_commit_changes_nothing(restarted):
    begin(restarted)
    add = (new(restarted, "more1", (0.0, 0.0, 0.0)),)
    with pytest.raises(errors.NameTaken):
        restarted.commit(Transaction(id="taken", source="operator", add=add))
    restarted.derive_all()
    assert agrees(restarted)


def test_asserted_locations_need_all_facts(restarted):
    begin(restarted)
    said = (v.entity_iri("more1"), v.dm("isOn"), v.entity_iri("more2"))
    restarted.commit(Transaction(id="said", source="operator", insert=(said,)))
    assert restarted._derived_all


def test_facts_are_derived_once(semantic_map):
    semantic_map.derive_all()
    assert not semantic_map.derive_some()
