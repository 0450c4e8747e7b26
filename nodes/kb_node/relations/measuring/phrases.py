"""Wording of relations and lengths, and of the measurement behind a relation that holds."""

from __future__ import annotations

from semmap.nodes.kb_node.relations.geometry.opening import joint_at
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring.arrangement import stands_on_floor
from semmap.nodes.kb_node.relations.measuring.containment import hollow_around
from semmap.nodes.kb_node.relations.measuring.measures import Measure
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.schemas import errors
from semmap.schemas.joints import OPEN_FROM, Joint, in_words
from semmap.schemas.relations import PHRASES, RelationName

UNSUPPORTED = "has no known support"
LEVEL_M = 0.00005
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
    if abs(gap_m) < LEVEL_M:
        return "level with"
    return f"{format_length(abs(gap_m))} {'above' if gap_m > 0.0 else 'below'}"


def explain_location(relation: RelationName, solid: Solid, other: Solid, made: Measure) -> str:
    """Return the measurement behind a stored relation, as a clause."""
    match relation:
        case "isOn" if made.holds and made.share == 0.0:
            return f"it has no other support and leans against a steep side of {other.name}"
        case "isOn":
            return (
                f"its bottom is {format_height(made.gap_m)} a surface of {other.name},"
                f" at {format_length(made.height_m)}, and {made.share:.0%} of its base is over it"
            )
        case "isInside" if made.by_edge:
            top = f"a top of {other.name}, at {format_length(made.height_m)}, which is around"
            return f"it is let into {top} {made.share:.0%} of its edge"
        case "isInside" if made.by_base:
            return f"{made.share:.0%} of its base is within {_hollow(solid, other)}, and it sticks out"
        case "isInside":
            return f"{made.share:.0%} of its volume is within {_hollow(solid, other)}"
        case "isLocatedIn":
            part = f"{made.share:.0%} of its footprint" if solid.is_measured else "its position"
            is_ = "is" if made.share > 0.0 else "is not"
            return f"{part} {is_} within {other.name}"
        case "isAttachedTo":
            return f"it has no support and is {format_length(made.gap_m)} from the side of {other.name}"
    raise errors.InternalError(f"the relation '{relation}' is not stored")


def describe_support(space: Space, solid: Solid) -> str:
    """Return what an object is inside or on, as a predicate: "is inside bowl1"."""
    container, supports, place = space.spatial_relations(solid)
    if container is not None:
        return f"is inside {container[0].name}"
    if supports:
        return f"is on {' and '.join(support.name for support, _ in supports)}"
    if place is not None and stands_on_floor(space, solid):
        return f"is on the floor of {place[0].name}"
    return UNSUPPORTED


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
