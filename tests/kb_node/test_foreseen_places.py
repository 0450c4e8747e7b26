"""A large load gives the same commit with and without a separate process for its relations."""

import random
import sys
from functools import partial

import pytest

from semmap.nodes.kb_node import map_state
from semmap.nodes.kb_node.answers import dry_runs
from semmap.nodes.kb_node.entities import new_entities
from semmap.nodes.kb_node.relations.facts.precomputation import Precomputation
from semmap.nodes.kb_node.relations.facts.precompute_messages import PrecomputeResult
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commits import NewEntity, Statement, Transaction
from semmap.schemas.entities import Pose, orientation_from_yaw
from tests.kb_node import home

pytestmark = pytest.mark.process  # a large commit starts one

MANY = 120
CLASSES = ("Table", "Cup", "Book", "Tray", "Fridge", "Kitchen")
DIES = [sys.executable, "-c", "raise SystemExit(9)"]


def things(count=2 * MANY, first=0, without=()):
    """Entities in and on one another and in rooms; some have no size, some no position."""
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
    monkeypatch.setattr(new_entities, "MANY", MANY)
    monkeypatch.setattr("semmap.schemas.commits._FEW", MANY)


@pytest.fixture
def helped(monkeypatch, few_are_many):
    """Counts how often the result of the other process was used."""
    came = []
    match = PrecomputeResult.match

    def counted(found, entities):
        facts = match(found, entities)
        came.append(facts is not None)
        return facts

    monkeypatch.setattr(PrecomputeResult, "match", counted)
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
    computed, facts = set(reasoner.computed()), set(semantic_map.derived_facts.computed.facts)
    return entities, commit.notes, commit.inserted, computed, set(reasoner.given()), facts


def alone(monkeypatch, semantic_map, *transactions):
    """Return the outcome of the last transaction without a prediction."""
    with monkeypatch.context() as patched:
        patched.setattr(new_entities, "MANY", 10**9)
        for transaction in transactions:
            commit = semantic_map.commit(transaction)
    return seen(semantic_map, commit)


@pytest.mark.parametrize("form", [wanted, said])
def test_a_load_gives_the_same_result_with_and_without_the_process(new_map, helped, monkeypatch, form):
    semantic_map, load = new_map(), form(things())
    there = seen(semantic_map, semantic_map.commit(load))
    assert helped == [True]
    assert there == alone(monkeypatch, new_map(), load)
    assert any(p == v.dm("isOn") for _, p, _ in there[3])


def test_existing_entities_are_included(new_map, helped, monkeypatch):
    first, second = wanted(things(90), "first"), said(things(200, first=90), "second")
    semantic_map = new_map()
    semantic_map.commit(first)
    there = seen(semantic_map, semantic_map.commit(second))
    assert helped == [True]
    assert there == alone(monkeypatch, new_map(), first, second)


def test_a_map_with_more_entities_than_the_load_has_no_prediction(new_map, helped):
    semantic_map = new_map()
    semantic_map.commit(wanted(things(3 * MANY), "first"))
    semantic_map.commit(wanted(things(2 * MANY, first=3 * MANY), "second"))
    assert helped == [True]


def test_small_loads_need_no_process(new_map, monkeypatch):
    monkeypatch.setattr(map_state, "Precomputation", None)
    semantic_map = new_map()
    assert semantic_map.commit(wanted(things())).changed
    assert semantic_map.commit(said(things(100, first=1000), "second")).changed


def test_a_wrong_prediction_is_corrected(new_map, helped, monkeypatch):
    """The entity has two classes, and the prediction used the model of the other one."""
    load = said(things())
    second = (v.entity_iri("table6"), v.RDF_TYPE, v.dm("Physical_Thing"))
    load = Transaction(id="load", source="file", reason="load", insert=(*load.insert, second))
    semantic_map = new_map()
    there = seen(semantic_map, semantic_map.commit(load))
    assert helped == [False]
    assert there == alone(monkeypatch, new_map(), load)


def test_a_process_that_dies_costs_only_time(new_map, few_are_many, monkeypatch, caplog):
    monkeypatch.setattr(map_state, "Precomputation", partial(Precomputation, command=DIES))
    semantic_map, load = new_map(), wanted(things())
    there = seen(semantic_map, semantic_map.commit(load))
    assert "precomputes facts failed" in caplog.text
    assert there == alone(monkeypatch, new_map(), load)


def test_a_process_that_does_not_start_is_not_needed(new_map, few_are_many, monkeypatch):
    monkeypatch.setattr(map_state, "Precomputation", partial(Precomputation, command=["/nowhere/python"]))
    semantic_map, load = new_map(), wanted(things())
    there = seen(semantic_map, semantic_map.commit(load))
    assert there == alone(monkeypatch, new_map(), load)


def test_a_rejected_load_leaves_no_process_behind(new_map, few_are_many, monkeypatch):
    processes = []

    def kept(*args):
        processes.append(Precomputation(*args))
        return processes[-1]

    monkeypatch.setattr(map_state, "Precomputation", kept)
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
    assert not set(semantic_map.derived_facts.computed.facts)
    assert set(semantic_map.reasoner.given()) == before
    assert semantic_map.commit(wanted(things())).changed


def test_a_dry_run_uses_the_prediction_and_changes_nothing(new_map, helped):
    semantic_map, load = new_map(), wanted(things())
    tried = dry_runs.dry_run(semantic_map, lambda: semantic_map.commit(load))
    assert helped == [True]
    assert not semantic_map.by_name
    assert semantic_map.commit(load).names == tried.names


def test_unusual_transactions_are_not_predicted(new_map, few_are_many):
    classes, new = new_map().classes, list(things())

    def has(load):
        return new_entities.predict_new_entities(load, classes) is not None

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
