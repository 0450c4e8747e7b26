"""What is computed of where things are, in a whole map: commits, undo, dry runs, the past, restarts."""

import random

import pytest

from nodes.kb_node import undo
from nodes.kb_node.answers import answers, trials
from nodes.kb_node.documents import rdf
from nodes.kb_node.semantic_map import SemanticMap
from nodes.kb_node.storage.history import Past
from nodes.kb_node.storage.journal import Journal
from ontology import FLAT_TTL, HOUSEHOLD_TTL
from ontology import vocabulary as v
from schemas.bridge import TakeBack
from schemas.commits import Edit, NewEntity, Transaction
from schemas.entities import Pose

TBOX = rdf.parse(HOUSEHOLD_TTL.read_bytes(), "household.ttl", label_prefix="t")
FLAT = tuple(rdf.parse(FLAT_TTL.read_bytes(), "flat.ttl", label_prefix="f"))
ON = v.dm("isOn")


@pytest.fixture
def flat(tmp_path):
    journal = Journal.create(tmp_path / "journal.sqlite", rdf.serialise(frozenset(TBOX), "ntriples"))
    made = SemanticMap(journal)
    made.commit(Transaction(id="flat", source="file", insert=FLAT))
    yield made
    made._journal.close()


def moved(semantic_map, name, at):
    edit = Edit(name=name, at=at)
    return Transaction(id=f"{semantic_map.seq} {name}", source="operator", verb="update", edit=(edit,))


def on(name, other):
    return (v.entity_iri(name), ON, v.entity_iri(other))


def state(semantic_map):
    reasoner = semantic_map.reasoner
    return (
        set(reasoner.given()),
        set(reasoner.set_aside()),
        {entity.name: entity.types for entity in semantic_map.entities()},
        len(reasoner),
    )


def test_a_thing_that_is_added_is_somewhere(flat):
    new = NewEntity(name="cup9", class_iri=v.bare(v.dm("Cup")), pose=Pose(position_m=(3.95, 0.55, 0.42)))
    commit = flat.commit(Transaction(id="cup", source="operator", add=(new,)))
    assert on("cup9", "coffee_table1") in set(flat.inferred("cup9"))
    assert on("cup9", "coffee_table1") not in commit.inserted
    assert flat.believed_of(commit).come


def test_what_comes_into_a_crowd_is_told_so(flat):
    assert flat.places.crowds() == ()
    pose = Pose(position_m=(3.95, 0.55, 0.42))
    cups = tuple(NewEntity(name=f"cup{k}", class_iri=v.bare(v.dm("Cup")), pose=pose) for k in range(50, 250))
    commit = flat.commit(Transaction(id="cups", source="operator", add=cups))
    (note,) = commit.notes
    assert note.endswith("what they are on or inside is looked for among the 100 largest")
    assert flat.places.crowds() == (note,)
    assert {on(f"cup{k}", "coffee_table1") for k in range(50, 250)} <= set(flat.inferred())
    elsewhere = flat.commit(moved(flat, "apple1", (8.2, 2.2, 0.74)))
    assert elsewhere.notes == ()


def test_who_is_in_another_class_by_where_things_are_is_in_the_commit(flat):
    bare = flat.entity("coffee_table1")
    for name in [v.entity_name(s) for s, _, _ in flat.reasoner.given(None, ON, v.iri(bare.iri))]:
        flat.commit(moved(flat, name, (3.0, 2.0, 0.0)))
    assert "Laden_Thing" not in flat.entity(bare.name).types
    commit = flat.commit(moved(flat, "cup1", (3.95, 0.55, 0.42)))
    assert {"cup1", bare.name} <= {entity.name for entity in commit.changed}
    assert "Laden_Thing" in flat.entity(bare.name).types
    assert bare.name in {entity.name for entity in flat.entities(v.dm("Laden_Thing"))}


def test_a_dry_run_tells_what_would_be_and_leaves_all(flat):
    before = state(flat)
    effects = trials.of(flat, lambda: flat.commit(moved(flat, "cup1", (2.0, 2.0, 0.0))))
    assert any("cup1 isLocatedIn livingroom1" in line for line in effects.trial.gained)
    assert state(flat) == before


def test_undo_and_the_past_and_a_restart_give_what_was(flat, tmp_path):
    dice = random.Random(7)
    movable = sorted(e.name for e in flat.entities() if e.pose is not None and not e.place and not e.fixed)
    spots = [flat.entity(name).pose.position_m for name in movable]
    states = {flat.seq: state(flat)}
    for _ in range(25):
        flat.commit(moved(flat, dice.choice(movable), dice.choice(spots)))
        states[flat.seq] = state(flat)
    last = flat.seq
    past = Past(flat._journal)
    for seq in dice.sample(sorted(states), 4):
        assert {e.name: e.types for e in past.entities(seq, None, ())} == states[seq][2]
    undo.undo(flat, flat._journal, TakeBack(id="back", source="operator", commit=last))
    assert state(flat) == states[last - 1]
    now = state(flat)
    flat._journal.close()
    replayed = SemanticMap(Journal(tmp_path / "journal.sqlite"))
    assert state(replayed) == now
    replayed.checkpoint()
    replayed._journal.close()
    kept = SemanticMap(Journal(tmp_path / "journal.sqlite"))
    assert state(kept) == now  # from the columns of the checkpoint
    kept.follow_places()
    assert state(kept) == now
    kept._journal.close()


def test_what_the_disk_does_not_take_is_taken_back(flat, monkeypatch):
    before = state(flat)

    def full(*_, **__):
        raise OSError("full")

    monkeypatch.setattr(flat._journal, "append", full)
    with pytest.raises(OSError, match="full"):
        flat.commit(moved(flat, "cup1", (2.0, 2.0, 0.0)))
    assert state(flat) == before


def test_what_contradicts_the_tbox_is_withheld_and_told(tmp_path):
    bare = b'dm:Counter rdfs:subClassOf [ a owl:Restriction ; owl:onProperty dm:supports ; owl:maxCardinality "0"^^xsd:nonNegativeInteger ] .'  # noqa: E501
    tbox = rdf.parse(HOUSEHOLD_TTL.read_bytes() + bare, "household.ttl", label_prefix="t")
    journal = Journal.create(tmp_path / "journal.sqlite", rdf.serialise(frozenset(tbox), "ntriples"))
    barred = SemanticMap(journal)
    barred.commit(Transaction(id="flat", source="file", insert=tuple(t for t in FLAT if t[1] != ON)))
    told = list(answers.withheld(barred))
    assert any(text.startswith("that milk1 is on counter1 (measured) would contradict") for text in told)
    assert not any("on counter1 (asserted)" in text for text in told)
    assert not barred.reasoner.holds(on("milk1", "counter1"))
    barred.commit(moved(barred, "milk1", (2.0, 2.0, 0.0)))
    assert len(list(answers.withheld(barred))) == len(told) - 1
    journal.close()
