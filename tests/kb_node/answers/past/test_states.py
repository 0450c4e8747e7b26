"""When a property had a value, and when two objects were near each other."""

import re

import pytest

from semmap.nodes.kb_node.answers.past.differences import find_spells
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.ontology import HOUSEHOLD_TTL
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import WasWhen
from semmap.schemas.commits import Edit, NewEntity, Statement, Transaction
from semmap.schemas.entities import Pose


def new(name, class_name, x, **fields):
    iri = v.bare(v.dm(class_name))
    return NewEntity(name=name, class_iri=iri, pose=Pose(position_m=(x, 0.0, 0.0)), **fields)


def is_open(value, name="fridge1"):
    return Edit(name=name, set=(Statement(property="isOpen", values=(str(value).lower(),)),))


@pytest.fixture(scope="module")
def ask(tmp_path_factory):
    """Commits: 1 the objects, 2 open, 3 moved away, 4 closed, 5 open and near again, 6 and 7 renamed."""
    journal = Journal.create(tmp_path_factory.mktemp("map") / "journal.sqlite", HOUSEHOLD_TTL.read_bytes())
    semantic_map = SemanticMap(journal)

    def commit(number, **fields):
        semantic_map.commit(Transaction(id=f"{number}", source="operator", **fields))

    others = (new("oven1", "Oven", 30.0), new("stool1", "Chair", 31.0))
    commit(1, add=(new("fridge1", "Fridge", 0.0), new("chair1", "Chair", 1.0), *others))
    commit(2, edit=(is_open(True), is_open(True, "oven1")))
    commit(3, edit=(Edit(name="chair1", at=(9.0, 0.0, 0.0)),))
    commit(4, edit=(is_open(False),))
    commit(5, edit=(is_open(True), Edit(name="chair1", at=(1.0, 0.0, 0.0))))
    commit(6, edit=(Edit(name="oven1", rename="stove1"),))
    commit(7, edit=(Edit(name="stool1", rename="oven1"),))

    reader = HistoryReader(journal)  # which derives the classes of the TBox once

    def find(name, relation, other=True):
        return find_spells(journal, reader, WasWhen(name=name, relation=relation, other=other), Thresholds())

    yield find
    journal.close()


@pytest.mark.parametrize(
    ("words", "spans", "text"),
    [
        (("fridge1", "isOpen"), [(2, 4), (5, None)], "fridge1 has been open since commit 5 ("),
        (("the fridge", "isopen", "true"), [(2, 4), (5, None)], "fridge1 has been open since commit 5 ("),
        (("fridge1", "isOpen", False), [(4, 5)], "fridge1 is no longer closed; it was from commit 4 until"),
        (("chair1", "isNear", "fridge1"), [(1, 3), (5, None)], "chair1 has been near fridge1 since commit 5"),
        (("chair1", "isOn", "fridge1"), [], "chair1 was never on fridge1"),
        (("stove1", "isOpen"), [(2, None)], "stove1 has been open since commit 2 ("),
        (("oven1", "isNear", "stove1"), [(1, None)], "oven1 has been near stove1 since commit 1 ("),
        (("stool1", "isNear", "stove1"), [(1, None)], "oven1 has been near stove1 since commit 1 ("),
        (("stove1", "isNear", "fridge1"), [], "stove1 was never near fridge1"),
    ],
)
def test_when_a_property_had_a_value(ask, words, spans, text):
    found = ask(*words)
    assert [(spell.since, spell.until) for spell in found.spells] == spans
    assert found.text.startswith(text)


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("fridge1", "isOpen", "flase"), "isOpen of fridge1 is true or false, not 'flase'"),
        (("fridge1", "isOpne"), "fridge1 never had the property 'isOpne'; did you mean isOpen?"),
        (
            ("chair1", "sits_on", "fridge1"),
            "chair1 never had the property 'sits_on'; did you mean isOn?; relations are isOn",
        ),
        (("chair1", "isNear"), "isNear requires the other entity"),
        (("chair9", "isOpen"), "no entity was ever named 'chair9'"),
    ],
)
def test_unknown_properties_are_errors(ask, words, text):
    with pytest.raises(errors.SemmapError, match=re.escape(text)):
        ask(*words)
