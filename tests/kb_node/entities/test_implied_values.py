"""Setting one joint property clears the values that it contradicts."""

from semmap.nodes.kb_node.entities.implied_values import imply_joint_values
from semmap.ontology import vocabulary as v

TRUE, FALSE = (v.literal(word, v.XSD_BOOLEAN) for word in ("true", "false"))
HALF, NONE = v.literal("0.5", v.XSD_FLOAT), v.literal("0.0", v.XSD_FLOAT)
DOOR = v.literal("door=0.8")
OPEN = {v.IS_OPEN: [TRUE], v.OPENNESS: [HALF], v.JOINT_POSITIONS: [DOOR]}


def test_setting_it_closed_clears_openness_and_joint_positions():
    assert imply_joint_values({v.IS_OPEN: [FALSE]}, OPEN) == {v.OPENNESS: [], v.JOINT_POSITIONS: []}


def test_openness_implies_whether_it_is_open():
    assert imply_joint_values({v.OPENNESS: [NONE]}, OPEN) == {v.IS_OPEN: [FALSE], v.JOINT_POSITIONS: []}
    assert imply_joint_values({v.OPENNESS: [HALF]}, {}) == {v.IS_OPEN: [TRUE]}


def test_values_that_are_set_together_are_kept():
    said = {v.IS_OPEN: [FALSE], v.OPENNESS: [NONE], v.JOINT_POSITIONS: [v.literal("door=0")]}
    assert imply_joint_values(said, OPEN) == {}


def test_unchanged_values_have_no_effect():
    assert imply_joint_values({v.IS_OPEN: [TRUE]}, OPEN) == {}
    assert imply_joint_values({v.dm("hasColor"): [v.dm("color_red")]}, OPEN) == {}


def test_switches_and_doors_are_independent():
    said = {**OPEN, v.IS_SWITCHED_ON: [TRUE], v.SWITCH_POSITIONS: [v.literal("knob=1")]}
    assert imply_joint_values({v.IS_SWITCHED_ON: [FALSE]}, said) == {v.SWITCH_POSITIONS: []}
    assert imply_joint_values({v.IS_OPEN: [FALSE]}, said) == {v.OPENNESS: [], v.JOINT_POSITIONS: []}
    both = {v.IS_OPEN: [FALSE], v.IS_SWITCHED_ON: [FALSE]}
    assert imply_joint_values(both, said) == {v.OPENNESS: [], v.JOINT_POSITIONS: [], v.SWITCH_POSITIONS: []}
