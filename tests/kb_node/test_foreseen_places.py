"""A large load is the same commit whether a process of its own worked out where everything is, or not."""

import random
import sys
from functools import partial

import pytest

from semmap.nodes.kb_node import map_state
from semmap.nodes.kb_node.answers import trials
from semmap.nodes.kb_node.entities import foreseeing
from semmap.nodes.kb_node.relations.facts.ahead import Ahead
from semmap.nodes.kb_node.relations.facts.foreseen import WorkedOut
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commits import NewEntity, Statement, Transaction
from semmap.schemas.entities import Pose, orientation_from_yaw
from tests.kb_node import home

pytestmark = pytest.mark.process  # a large commit of a map starts one

MANY = 120
CLASSES = ("Table", "Cup", "Book", "Tray", "Fridge", "Kitchen")
DIES = [sys.executable, "-c", "raise SystemExit(9)"]


def things(count=2 * MANY, first=0, without=()):
    """They stand in one another, on one another and in rooms; some have no size, some no position."""
    dice = random.Random(first)
    for i in range(first, first + count):
        class_name = CLASSES[i % len(CLASSES)]
        at = (dice.uniform(0, 6), dice.uniform(0, 6), dice.choice([0.0, 0.75, 0.78, 0.4]))
        turn = orientation_from_yaw(dice.uniform(0, 3)) if "turn" not in without and i % 7 == 0 else None
        pose = Pose(position_m=at, orientation_wxyz=turn) if turn else Pose(position_m=at)
        size = None if i % 5 == 0 else tuple(dice.uniform(0.1, 0.6) for _ in range(3))
        yield NewEntity(
            name=f"{class_name.lower()}{i}",
            class_iri=v.bare(v.dm(class_name)),
            pose=None if i % 11 == 0 else pose,
            size=(3.0, 3.0, 2.5) if class_name == "Kitchen" else size,
            ref=class_name.lower(),
        )


def wanted(new, name="load"):
    return Transaction(id=name, source="file", reason="load", add=tuple(new))


def said(new, name="load"):
    triples = [
        triple
        for one in new
        for triple in entity_triples.describe(
            one.name, v.iri(one.class_iri), pose=one.pose, size_m=one.size, preferred=one.ref
        )
    ]
    return Transaction(id=name, source="file", reason="load", insert=tuple(triples))


@pytest.fixture
def few_are_many(monkeypatch):
    monkeypatch.setattr(foreseeing, "MANY", MANY)
    monkeypatch.setattr("semmap.schemas.commits._FEW", MANY)


@pytest.fixture
def helped(monkeypatch, few_are_many):
    """How often the other process worked it out, as it turned out to be."""
    came = []
    if_came = WorkedOut.if_came

    def counted(found, entities):
        facts = if_came(found, entities)
        came.append(facts is not None)
        return facts

    monkeypatch.setattr(WorkedOut, "if_came", counted)
    return came


@pytest.fixture
def new_map(tmp_path):
    made = []

    def new():
        folder = tmp_path / str(len(made))
        folder.mkdir()
        made.append(SemanticMap(home.new_household_journal(folder)))
        return made[-1]

    yield new
    for one in made:
        home.close(one)


def seen(semantic_map, commit):
    reasoner = semantic_map.reasoner
    entities = [(e.name, e.types, e.pose, e.size_m, e.model) for e in commit.changed]
    computed, facts = set(reasoner.computed()), set(semantic_map.beliefs.computed.facts)
    return entities, commit.notes, commit.inserted, computed, set(reasoner.given()), facts


def alone(monkeypatch, semantic_map, *transactions):
    """What is seen of the last one where nothing is foreseen."""
    with monkeypatch.context() as patched:
        patched.setattr(foreseeing, "MANY", 10**9)
        for transaction in transactions:
            commit = semantic_map.commit(transaction)
    return seen(semantic_map, commit)


@pytest.mark.parametrize("form", [wanted, said])
def test_with_a_process_and_without_a_load_is_the_same(new_map, helped, monkeypatch, form):
    semantic_map, load = new_map(), form(things())
    there = seen(semantic_map, semantic_map.commit(load))
    assert helped == [True]
    assert there == alone(monkeypatch, new_map(), load)
    assert any(p == v.dm("isOn") for _, p, _ in there[3])


def test_what_is_there_already_counts(new_map, helped, monkeypatch):
    first, second = wanted(things(90), "first"), said(things(200, first=90), "second")
    semantic_map = new_map()
    semantic_map.commit(first)
    there = seen(semantic_map, semantic_map.commit(second))
    assert helped == [True]
    assert there == alone(monkeypatch, new_map(), first, second)


def test_where_more_is_there_than_comes_nothing_is_foreseen(new_map, helped):
    semantic_map = new_map()
    semantic_map.commit(wanted(things(3 * MANY), "first"))
    semantic_map.commit(wanted(things(2 * MANY, first=3 * MANY), "second"))
    assert helped == [True]


def test_few_need_no_process(new_map, monkeypatch):
    monkeypatch.setattr(map_state, "Ahead", None)
    semantic_map = new_map()
    assert semantic_map.commit(wanted(things())).changed
    assert semantic_map.commit(said(things(100, first=1000), "second")).changed


def test_a_guess_that_was_wrong_is_worked_out_here(new_map, helped, monkeypatch):
    """Two classes are said of one, and the guess took the other one's model."""
    load = said(things())
    second = (v.entity_iri("table6"), v.RDF_TYPE, v.dm("Physical_Thing"))
    load = Transaction(id="load", source="file", reason="load", insert=(*load.insert, second))
    semantic_map = new_map()
    there = seen(semantic_map, semantic_map.commit(load))
    assert helped == [False]
    assert there == alone(monkeypatch, new_map(), load)


def test_a_process_that_dies_costs_nothing_but_time(new_map, few_are_many, monkeypatch, caplog):
    monkeypatch.setattr(map_state, "Ahead", partial(Ahead, command=DIES))
    semantic_map, load = new_map(), wanted(things())
    there = seen(semantic_map, semantic_map.commit(load))
    assert "working out ahead" in caplog.text
    assert there == alone(monkeypatch, new_map(), load)


def test_one_that_does_not_start_is_done_without(new_map, few_are_many, monkeypatch):
    monkeypatch.setattr(map_state, "Ahead", partial(Ahead, command=["/nowhere/python"]))
    semantic_map, load = new_map(), wanted(things())
    there = seen(semantic_map, semantic_map.commit(load))
    assert there == alone(monkeypatch, new_map(), load)


def test_a_load_that_is_refused_leaves_no_process_and_nothing_behind(new_map, few_are_many, monkeypatch):
    processes = []

    def kept(*args):
        processes.append(Ahead(*args))
        return processes[-1]

    monkeypatch.setattr(map_state, "Ahead", kept)
    semantic_map = new_map()
    before = set(semantic_map.reasoner.given())
    again = [*things(), next(things())]
    with pytest.raises(errors.NameTaken):
        semantic_map.commit(wanted(again))
    wrong = (v.entity_iri("table0"), v.RDF_TYPE, v.dm("Location"))
    load = said(things())
    with pytest.raises(errors.Inconsistent):
        semantic_map.commit(Transaction(id="no", source="file", insert=(*load.insert, wrong)))
    assert [ahead._process.poll() is None for ahead in processes] == [False, False]
    assert not set(semantic_map.beliefs.computed.facts)
    assert set(semantic_map.reasoner.given()) == before
    assert semantic_map.commit(wanted(things())).changed


def test_a_dry_run_foresees_too_and_changes_nothing(new_map, helped):
    semantic_map, load = new_map(), wanted(things())
    tried = trials.of(semantic_map, lambda: semantic_map.commit(load))
    assert helped == [True]
    assert not semantic_map.by_name
    assert semantic_map.commit(load).names == tried.names


def test_what_is_not_plain_is_not_foreseen(new_map, few_are_many):
    classes, new = new_map().classes, list(things())

    def has(load):
        return foreseeing.coming(load, classes) is not None

    assert has(wanted(new))
    assert has(said(new))
    text = Statement(property="isOpen", values=("true",))
    assert not has(wanted([*new, NewEntity(name="fridge99", class_iri=new[4].class_iri, set=(text,))]))
    assert not has(wanted([*new, NewEntity(name="odd1", class_iri="urn:Odd")]))
    insert = said(new).insert
    extent = (v.entity_iri("kitchen5"), v.HAS_EXTENT, v.literal("POLYGON ((0 0, 1 0, 1 1))"))
    for more in (extent, (v.entity_iri("x1"), v.HAS_POSITION, v.entity_iri("y1"))):
        assert not has(Transaction(id="x", source="file", insert=(*insert, more)))
    assert not has(Transaction(id="x", source="file", insert=insert, retract=(extent,)))
