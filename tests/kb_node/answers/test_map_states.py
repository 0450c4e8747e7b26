"""A map of the past, measured again."""

from __future__ import annotations

import pytest
from msgspec import structs

from semmap.nodes.kb_node.answers.map_states import PastState
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.ontology import vocabulary as v
from tests.kb_node.relations.entities import thing


def stated(entity, **properties):
    return structs.replace(entity, iri=v.bare(v.entity_iri(entity.name)), properties=properties)


TABLE = stated(thing("table1", (0.0, 0.0, 0.0)))
SHELF = stated(thing("table2", (5.0, 0.0, 0.0)))


def state_of(**properties):
    cup = stated(thing("cup1", (0.0, 0.0, 0.75)), **properties)
    return PastState([TABLE, SHELF, cup], Thresholds())


def test_it_has_its_entities_and_what_they_are_on():
    state = state_of()
    assert {one.name for one in state.entities()} == {"table1", "table2", "cup1"}
    assert state.find("cup1").name == "cup1"
    assert state.find("cup2") is None
    assert ("isOn", "table1") in list(state.about("cup1"))
    assert list(state.about("cup2")) == []
    assert set(state.with_supported(["cup1"])) == {"table1", "table2", "cup1"}
    assert state.left_out() == frozenset()
    assert state.nameless(TABLE) == {}


@pytest.mark.parametrize(
    ("properties", "denied"),
    [
        ({"isOn": "table2"}, [("cup1", "isOn", "table2")]),
        ({"isOn": ("table1", "table2")}, [("cup1", "isOn", "table2")]),
        ({"isOn": "table1"}, []),
        ({"isOn": "table9"}, []),
        ({"isOn": ("table9", 4, True)}, []),
        ({"isBeside": "table2"}, []),
        ({}, []),
    ],
)
def test_asserted_locations_that_the_geometry_contradicts_are_found(properties, denied):
    found = list(state_of(**properties).find_denied())
    assert [(one.subject, one.relation, one.object) for one in found] == denied
