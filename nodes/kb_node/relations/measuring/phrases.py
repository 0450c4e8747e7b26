"""Wording of relations and lengths, and of the measurement behind a relation that holds."""

from __future__ import annotations

from semmap.nodes.kb_node.relations.geometry.opening import joint_at
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring.measures import Measure, hollow_around
from semmap.nodes.kb_node.relations.measuring.relation_table import PHRASES
from semmap.schemas.joints import OPEN_FROM, Joint, in_words
from semmap.schemas.relations import RelationName

_LEVEL_M = 0.00005
"""Smaller distances would be printed as 0.0 mm."""


def phrase_relation(relation: RelationName, holds: bool = True) -> str:
    """Return a relation as a verb phrase: "is on", "is not on", "does not touch"."""
    if holds:
        return PHRASES[relation]
    return "does not touch" if relation == "touches" else PHRASES[relation].replace("is ", "is not ", 1)


def format_length(value: float) -> str:
    """Return a length in mm, cm or m."""
    if abs(value) < 0.01:
        return f"{1000.0 * value:.1f} mm"
    return f"{100.0 * value:.1f} cm" if abs(value) < 1.0 else f"{value:.2f} m"


def format_height(gap_m: float) -> str:
    """Return the height of a bottom relative to a surface, such as "3.0 cm above"."""
    if abs(gap_m) < _LEVEL_M:
        return "level with"
    return f"{format_length(abs(gap_m))} {'above' if gap_m > 0.0 else 'below'}"


def explain_measure(relation: RelationName, solid: Solid, other: Solid, made: Measure) -> str:
    """Return the measurement behind a relation, as a clause."""
    match relation:
        case "isOn" if made.holds and made.share == 0.0:
            return f"it has no other support and leans against a steep side of {other.name}"
        case "isOn":
            return (
                f"its bottom is {format_height(made.gap_m)} a surface of {other.name},"
                f" at {format_length(made.height_m)}, and {made.share:.0%} of its base is over it"
            )
        case "isInside" if made.by_base:
            return f"{made.share:.0%} of its base is within {_hollow(solid, other)}, and it sticks out"
        case "isInside":
            return f"{made.share:.0%} of its volume is within {_hollow(solid, other)}"
        case "isLocatedIn":
            part = f"{made.share:.0%} of its footprint" if solid.is_measured else "its position"
            is_ = "is" if made.share > 0.0 else "is not"
            return f"{part} {is_} within {other.name}"
        case "isUnder":
            below = format_length(made.gap_m)
            return f"its top is {below} below {other.name}, which is over {made.share:.0%} of it"
        case "isAbove":
            return f"it is {format_length(made.gap_m)} above {other.name}, and over {made.share:.0%} of that"
        case "isAttachedTo":
            return f"it has no support and is {format_length(made.gap_m)} from the side of {other.name}"
        case "touches":
            return f"they are {format_length(made.gap_m)} apart" if made.gap_m > _LEVEL_M else "they meet"
        case "isNextTo":
            return (
                f"they are {format_length(made.gap_m)} apart on the same support, with nothing between them"
            )
    limit = format_length(made.limit)
    return f"they are {format_length(made.gap_m)} apart (isNear allows up to {limit} for their sizes)"


def _hollow(solid: Solid, other: Solid) -> str:
    """Return the hollow that holds most of an object, with the state of its doors or drawer."""
    positions = other.form.joints
    if not positions or not other.hollows:
        return f"a hollow of {other.name}"
    joints = {
        leaf.name: joint_at(leaf, position)
        for leaf, position in zip(other.form.shape.leaves, positions, strict=True)
    }
    hollow = hollow_around(solid, other)
    if (drawer := hollow.carried_by) in joints:
        return f"{drawer} of {other.name}, which is {_describe_joint(joints[drawer])}"
    doors = [f"{name}, which is {_describe_joint(joints[name])}" for name in hollow.behind if name in joints]
    return f"a hollow of {other.name}{', behind ' if doors else ''}{', and '.join(doors)}"


def _describe_joint(joint: Joint) -> str:
    """Return the state of a joint as an adjective: "closed", "open to 50%"."""
    share = joint.openness
    if share is None:
        return f"at {in_words(joint).rpartition(' at ')[2]}"
    return "closed" if share < OPEN_FROM else f"open to {share:.0%}"
