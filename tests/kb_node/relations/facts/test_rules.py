"""Which solids a new or removed one may concern."""

import pytest

from semmap.nodes.kb_node.relations.facts.rules import COMPUTED, RULES
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.ontology import vocabulary as v
from tests.kb_node.relations.entities import ROOM, thing

SPATIAL, ATTACHED = RULES
BLOCK = thing("block1", (0.0, 0.0, 1.0), "", size=(1.0, 1.0, 0.5))
BOARD = thing("board1", (0.0, 0.0, 1.0), "", size=(1.0, 1.0, 0.02))


@pytest.mark.parametrize(
    ("entity", "z", "may_be_on", "may_be_attached"),
    [
        (BLOCK, 1.5, True, True),
        (BLOCK, 1.54, True, True),
        (BLOCK, 1.56, False, False),
        (BLOCK, 1.46, True, True),
        (BLOCK, 1.44, False, True),  # it is beside it
        (BLOCK, 1.0, False, False),
        (BLOCK, 0.5, False, False),
        (BOARD, 1.0, True, False),  # both are on one floor
        (BOARD, 0.999, True, False),
        (BOARD, 0.99, False, False),
        (BOARD, 1.08, False, False),
        (ROOM, 9.0, True, True),
    ],
)
def test_a_solid_concerns_what_may_rest_on_it_or_hang_on_it(entity, z, may_be_on, may_be_attached):
    space = Space([entity, thing("a1", (0.0, 0.0, z), "", size=(0.1, 0.1, 0.1))])
    one, other = space.solids[entity.name], space.solids["a1"]
    assert SPATIAL.concerns(space, one, other) == may_be_on
    assert ATTACHED.concerns(space, one, other) == may_be_attached
    assert (SPATIAL.margin_m(space.limits), ATTACHED.margin_m(space.limits)) == (0.0, 0.02)


def test_the_computed_properties_are_those_of_the_rules():
    assert {v.dm(name): name for name in ("isInside", "isOn", "isLocatedIn", "isAttachedTo")} == COMPUTED
