"""Computed facts in a whole map: commits, undo, dry runs, the past and restarts."""

import random

import pytest

from semmap.nodes.kb_node import undo
from semmap.nodes.kb_node.answers import answers, dry_runs, questions
from semmap.nodes.kb_node.answers.entity_queries import CurrentState
from semmap.nodes.kb_node.answers.location_queries import LocationQueries
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.kb_node.storage.journal.sqlite_file import NotWritten
from semmap.ontology import FLAT_TTL, HOUSEHOLD_TTL
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.bridge import Entities, TakeBack
from semmap.schemas.commands import Explain, Get, Relations, Watch
from semmap.schemas.commits import Edit, NewEntity, Transaction
from semmap.schemas.entities import Pose
from semmap.schemas.relations import Where
from tests.kb_node import home

FLAT = tuple(rdf.parse(FLAT_TTL.read_bytes(), "flat.ttl", label_prefix="f"))
ON = v.dm("isOn")


@pytest.fixture
def flat(tmp_path):
    journal = home.new_household_journal(tmp_path)
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
        set(reasoner.suppressed()),
        {entity.name: entity.types for entity in semantic_map.entities()},
        len(reasoner),
    )


def test_a_new_entity_has_a_location(flat):
    new = NewEntity(name="cup9", class_iri=v.bare(v.dm("Cup")), pose=Pose(position_m=(3.95, 0.55, 0.42)))
    commit = flat.commit(Transaction(id="cup", source="operator", add=(new,)))
    assert on("cup9", "coffee_table1") in set(flat.inferred("cup9"))
    assert on("cup9", "coffee_table1") not in commit.inserted
    assert flat.take_derived_changes(commit).come


def test_a_crowd_is_reported(flat):
    assert flat.places.crowds() == ()
    pose = Pose(position_m=(3.95, 0.55, 0.42))
    cups = tuple(NewEntity(name=f"cup{k}", class_iri=v.bare(v.dm("Cup")), pose=pose) for k in range(50, 250))
    commit = flat.commit(Transaction(id="cups", source="operator", add=cups))
    (note,) = commit.notes
    assert note.endswith("relations (on, inside, beside) are computed only with the 100 largest")
    assert flat.places.crowds() == (note,)
    assert {on(f"cup{k}", "coffee_table1") for k in range(50, 250)} <= set(flat.inferred())
    elsewhere = flat.commit(moved(flat, "apple1", (8.2, 2.2, 0.74)))
    assert elsewhere.notes == ()


def test_an_entity_whose_class_changes_with_its_location_is_in_the_commit(flat):
    bare = flat.entity("coffee_table1")
    for name in [v.entity_name(s) for s, _, _ in flat.reasoner.given(None, ON, v.iri(bare.iri))]:
        flat.commit(moved(flat, name, (3.0, 2.0, 0.0)))
    assert "Laden_Thing" not in flat.entity(bare.name).types
    commit = flat.commit(moved(flat, "cup1", (3.95, 0.55, 0.42)))
    assert {"cup1", bare.name} <= {entity.name for entity in commit.changed}
    assert "Laden_Thing" in flat.entity(bare.name).types
    assert bare.name in {entity.name for entity in flat.entities(v.dm("Laden_Thing"))}


def test_a_dry_run_reports_the_effects_and_changes_nothing(flat):
    before = state(flat)
    effects = dry_runs.dry_run(flat, lambda: flat.commit(moved(flat, "cup1", (2.0, 2.0, 0.0))))
    assert any("cup1 isLocatedIn livingroom1" in line for line in effects.trial.gained)
    assert state(flat) == before


def test_undo_past_and_restart_restore_the_facts(flat, tmp_path):
    dice = random.Random(7)
    movable = sorted(e.name for e in flat.entities() if e.pose is not None and not e.place and not e.fixed)
    spots = [flat.entity(name).pose.position_m for name in movable]
    states = {flat.seq: state(flat)}
    for _ in range(25):
        flat.commit(moved(flat, dice.choice(movable), dice.choice(spots)))
        states[flat.seq] = state(flat)
    last = flat.seq
    past = HistoryReader(flat._journal)
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
    kept.derive_all()
    assert state(kept) == now
    kept._journal.close()


def test_a_failed_write_is_rolled_back(flat, monkeypatch):
    before = state(flat)
    monkeypatch.setattr(flat._journal, "append", _full)
    with pytest.raises(NotWritten, match="full"):
        flat.commit(moved(flat, "cup1", (2.0, 2.0, 0.0)))
    assert state(flat) == before


def test_a_failed_or_tried_removal_changes_nothing(flat, monkeypatch):
    before = state(flat)
    for name in ("milk1", "counter1", "kitchen1"):
        removal = Transaction(id=f"without {name}", source="operator", remove=(name,))
        dry_runs.dry_run(flat, lambda wanted=removal: flat.commit(wanted))
        assert state(flat) == before
        with monkeypatch.context() as patched:
            patched.setattr(flat._journal, "append", _full)
            with pytest.raises(NotWritten, match="full"):
                flat.commit(removal)
        assert state(flat) == before


def _full(*_, **__):
    raise NotWritten("full")


def test_a_contradiction_with_the_tbox_is_suppressed_and_reported(tmp_path):
    bare = b'dm:Counter rdfs:subClassOf [ a owl:Restriction ; owl:onProperty dm:supports ; owl:maxCardinality "0"^^xsd:nonNegativeInteger ] .'  # noqa: E501
    tbox = rdf.parse(HOUSEHOLD_TTL.read_bytes() + bare, "household.ttl", label_prefix="t")
    journal = Journal.create(tmp_path / "journal.sqlite", rdf.serialise(frozenset(tbox), "ntriples"))
    barred = SemanticMap(journal)
    barred.commit(Transaction(id="flat", source="file", insert=tuple(t for t in FLAT if t[1] != ON)))
    told = list(answers.suppressed_facts(barred))
    assert any(text.startswith("'milk1 is on counter1' (measured) is suppressed, because") for text in told)
    assert not any("on counter1 (asserted)" in text for text in told)
    assert not barred.reasoner.holds(on("milk1", "counter1"))
    barred.commit(moved(barred, "milk1", (2.0, 2.0, 0.0)))
    assert len(list(answers.suppressed_facts(barred))) == len(told) - 1
    journal.close()


ONLY_SHELVES = b"""
dm:Counter owl:disjointWith dm:Shelf .
dm:Milk rdfs:subClassOf [ a owl:Restriction ; owl:onProperty dm:isOn ; owl:allValuesFrom dm:Shelf ] .
"""


@pytest.fixture
def choosy(flat):
    """The flat with a TBox that allows milk only on shelves, and the commit that set it."""
    tbox = rdf.parse(HOUSEHOLD_TTL.read_bytes() + ONLY_SHELVES, "household.ttl", label_prefix="t")
    flat.derive_all()
    commit = flat.replace_tbox(Transaction(id="choosy", source="operator"), tbox)
    return flat, commit


def test_all_queries_agree_with_suppressed_facts(choosy):
    semantic_map, _ = choosy
    now = CurrentState(semantic_map)
    assert not semantic_map.reasoner.holds(on("milk1", "counter1"))
    there = now.entities(Entities(where=Where(on="counter1")))
    assert "milk1" not in {entity.name for entity in there}
    assert there
    watching = LocationQueries(semantic_map, lambda _: None).watch(Watch(id="w", on="counter1"))
    assert watching.rows == tuple((v.iri(entity.iri),) for entity in there)
    milk = now.entity(Get(name="milk1", where=True))
    assert "isOn" not in {relation.relation for relation in milk.whereabouts}
    assert ["'milk1 is on counter1' (measured) is suppressed" in text for text in milk.withheld] == [True]
    (told,) = [r for r in now.relations(Relations(name="milk1")) if r.relation == "isOn"]
    assert told.text.endswith("because it would contradict the map (for the reason see: semmap check)")
    question = Explain(name="milk1", predicate="isOn", value="counter1")
    with pytest.raises(errors.Refused, match=r"measured.* would contradict the map"):
        now.explain(question, questions.parse_explain(semantic_map, question))


def test_the_support_reports_suppressed_facts_too(choosy):
    semantic_map, _ = choosy
    counter = CurrentState(semantic_map).entity(Get(name="counter1", where=True))
    assert ["'milk1 is on counter1' (measured) is suppressed" in text for text in counter.withheld] == [True]


def test_a_dry_run_of_another_tbox_notes_suppressed_facts(flat):
    tbox = rdf.parse(HOUSEHOLD_TTL.read_bytes() + ONLY_SHELVES, "household.ttl", label_prefix="t")
    seen = []
    tried = dry_runs.dry_run(
        flat,
        lambda: flat.replace_tbox(Transaction(id="choosy", source="operator"), tbox),
        lambda: seen.append(flat.tbox),
    )
    assert tried is not None
    assert seen == [frozenset(tbox)]
    assert flat.tbox == home.household()


def test_an_entity_that_is_located_in_itself_is_noted(flat):
    said = (v.entity_iri("kitchen1"), v.dm("isLocatedIn"), v.entity_iri("kitchen1"))
    commit = flat.commit(Transaction(id="self", source="operator", insert=(said,)))
    note = "kitchen1 was asserted to be in kitchen1; an object cannot be on, in or inside itself"
    assert commit.notes == (note,)
    assert [relation.text for relation in CurrentState(flat).find_denied()] == [note]


def test_an_indirect_contradiction_with_a_denied_assertion_is_rejected(flat):
    """The cup is asserted to be on the counter, which is in the kitchen, which has no cups by assertion."""
    axioms = b"""
    dm:Gadget a owl:Class ; rdfs:subClassOf dm:Object .
    dm:Tidy_Room a owl:Class ; rdfs:subClassOf dm:Location ;
        rdfs:subClassOf [ a owl:Restriction ; owl:onProperty dm:contains ;
            owl:allValuesFrom [ a owl:Class ; owl:complementOf dm:Gadget ] ] .
    """
    tbox = rdf.parse(HOUSEHOLD_TTL.read_bytes() + axioms, "household.ttl", label_prefix="t")
    flat.replace_tbox(Transaction(id="tbox", source="operator"), tbox)
    iri, pose = v.bare(v.dm("Gadget")), Pose(position_m=(2.0, 2.0, 0.0))
    new = NewEntity(name="gadget1", class_iri=iri, pose=pose, size=(0.1, 0.1, 0.1))
    located = (v.entity_iri("counter1"), v.dm("isLocatedIn"), v.entity_iri("kitchen1"))
    flat.commit(Transaction(id="gadget", source="operator", add=(new,), insert=(located,)))
    said = flat.commit(Transaction(id="said", source="operator", insert=(on("gadget1", "counter1"),)))
    assert len(said.notes) == 1
    tidy = (v.entity_iri("kitchen1"), v.RDF_TYPE, v.dm("Tidy_Room"))
    before = state(flat)
    with pytest.raises(
        errors.Inconsistent, match=r"it is on counter1 \(asserted\), counter1 is located in kitchen1"
    ):
        flat.commit(Transaction(id="tidy", source="operator", insert=(tidy,)))
    assert state(flat) == before


def test_a_suppressed_fact_is_noted_once(choosy):
    semantic_map, commit = choosy
    (note,) = [note for note in commit.notes if "milk1 is on counter1" in note]
    assert "counter1 (measured)" in note
    away = semantic_map.commit(moved(semantic_map, "milk1", (2.0, 2.0, 0.0)))
    assert not away.notes
    assert not semantic_map.derived_facts.suppressed
    there = (8.2, 0.3, 0.9)
    tried = dry_runs.dry_run(semantic_map, lambda: semantic_map.commit(moved(semantic_map, "milk1", there)))
    back = semantic_map.commit(moved(semantic_map, "milk1", there))
    assert back.notes == tried.notes == (note,)
    assert not semantic_map.commit(moved(semantic_map, "milk1", (8.21, 0.3, 0.9))).notes


def test_a_standing_query_follows_suppressed_facts(choosy):
    semantic_map, _ = choosy
    news = []
    standing = LocationQueries(semantic_map, news.append)
    standing.watch(Watch(id="w", on="counter1", lease=3600.0))
    milk = v.iri(semantic_map.entity("milk1").iri)
    semantic_map.replace_tbox(Transaction(id="plain", source="operator"), home.household())
    standing.follow(semantic_map.seq, ())
    assert [told.rows.appeared for told in news] == [((milk,),)]
