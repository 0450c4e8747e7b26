"""Fixtures that are let into a top."""

import pytest
from msgspec import structs

from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.relation_reports import explain_relation
from semmap.ontology import model_shapes
from tests.kb_node.relations.entities import ROOM, thing
from tests.kb_node.relations.facts.test_many_at_once import require_alike

COUNTER = thing("counter1", (0.0, 0.0, 0.0), "", size=(0.6, 2.0, 0.9))
TOP = 0.9


@pytest.fixture(autouse=True)
def _counter_with_a_cut_out():
    """Use a counter on two sides, whose top has a hole of 40 cm by 50 cm."""
    boxes = (
        *(((0.0, y, 0.43), (0.3, 0.02, 0.43)) for y in (-0.98, 0.98)),
        *(((0.0, y, 0.88), (0.3, 0.375, 0.02)) for y in (-0.625, 0.625)),
        *(((x, 0.0, 0.88), (0.05, 0.25, 0.02)) for x in (-0.25, 0.25)),
    )
    parts = tuple(
        model_shapes.ConvexPart(centre=at, straight=((x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z)))
        for at, (x, y, z) in boxes
    )
    shape = model_shapes.ModelShape(size_m=COUNTER.size_m, parts=parts)
    model_shapes.exchange_world(model_shapes.WorldShapes.of({"counter1": shape}))
    yield
    model_shapes.exchange_world(model_shapes.WorldShapes())


def sink(x=0.0, height=TOP - 0.2, *, size=(0.39, 0.49, 0.21), fixed=True):
    return structs.replace(thing("sink1", (x, 0.0, height), "", size=size), fixed=fixed)


@pytest.mark.parametrize(
    ("fixture", "is_inside"),
    [
        pytest.param(sink(), True, id="level with the top"),
        pytest.param(sink(size=(0.39, 0.49, 0.6)), True, id="with a tap above the top"),
        pytest.param(sink(height=TOP - 0.24), True, id="under the top"),
        pytest.param(sink(size=(0.44, 0.54, 0.21)), True, id="with a rim on the top"),
        pytest.param(sink(0.05, size=(0.5, 0.49, 0.21)), True, id="at the front"),
        pytest.param(sink(fixed=False), False, id="not fixed"),
        pytest.param(sink(height=TOP), False, id="on the top"),
        pytest.param(sink(height=0.3), False, id="below the top"),
        pytest.param(sink(1.0), False, id="in front"),
        pytest.param(sink(size=(0.2, 0.2, 0.2)), False, id="smaller than the hole"),
    ],
)
def test_a_fixture_is_inside_what_surrounds_its_edge(fixture, is_inside):
    facts = require_alike([ROOM, COUNTER, fixture])
    assert (("sink1", "isInside", "counter1") in facts) == is_inside


def test_the_explanation_names_the_top_and_the_edge():
    found = explain_relation(
        Space([ROOM, COUNTER, sink(0.05, size=(0.5, 0.49, 0.21))]), "sink1", "isInside", "counter1"
    )
    assert found.holds
    assert "it is let into a top of counter1, at 90.0 cm, which is around 75% of its edge" in found.text
