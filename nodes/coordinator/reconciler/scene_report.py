"""Sentences about differences between map and scene, as `semmap status` lists them. Pure functions."""

from __future__ import annotations

from collections.abc import Callable, Collection, Container, Iterator, Mapping

from semmap.nodes.coordinator.reconciler.reconcile import grip_order
from semmap.schemas import wording
from semmap.schemas.entities import BodyState, Entity
from semmap.schemas.scenes import Body


def entity_problems(
    entities: Collection[Entity], state_of: Callable[[Entity], BodyState] | None
) -> Iterator[str]:
    """Yield the entities whose body failed or is missing, then those that perception contradicts.

    `state_of(entity)` returns the state of its body. It is None if entities need no bodies.
    """
    states = ((e.name, state_of(e)) for e in entities) if state_of is not None else ()
    yield from sorted(
        f"{name}: {state.status}{': ' if state.detail else ''}{state.detail}"
        for name, state in states
        if state.status in ("failed", "ghost", "missing")
    )


def unstable_bodies(names: Collection[str]) -> list[str]:
    """Return the bodies whose simulation was not stable."""
    return [
        f"{name}: its simulated state was not finite, so it was stopped; use a smaller timestep, a larger"
        " mass, or softer joints and contacts in its world file or model"
        for name in names
    ]


def perception_conflicts(entities: Collection[Entity]) -> list[str]:
    """Return the entities that perception contradicts."""
    return sorted(f"{e.name}: perception: {e.conflict}" for e in entities if e.conflict)


def names_like_text(entities: Collection[Entity]) -> list[str]:
    """Return the entities of agents whose names read like a text."""
    return sorted(
        f"{e.name}: the name reads like a text, and an agent defined it; to change it: semmap rename"
        for e in entities
        if e.shape_provenance.source == "agent" and wording.reads_like_text(e.name)
    )


def failed_attachments(failed: Mapping[str, tuple[int, str]], entities: Mapping[str, Entity]) -> list[str]:
    """Return the attachments that the scene rejected: `failed` maps a name to the commit and the reason."""
    return sorted(
        f"{name}: is not attached in the scene as in the map: {reason}"
        for name, (commit, reason) in failed.items()
        if (entity := entities.get(name)) is not None and grip_order(entity).commit == commit
    )


def fallen_robots(bodies: Collection[Body]) -> list[str]:
    """Return the robots that have fallen over."""
    return [f"{b.name} {wording.fallen(b.name, b.pose)}" for b in bodies if b.has_fallen]


def bodies_to_adopt(
    bodies: Collection[Body],
    entities: Container[str],
    rejected: Container[str],
    whole_of: Callable[[Body], str],
) -> list[str]:
    """Return the bodies that will become entities, and the condition that each waits for."""
    waiting = [body for body in bodies if body.name not in entities and body.name not in rejected]
    moving = [body.name for body in waiting if not body.resting]
    wholes = [(body.name, whole_of(body)) for body in waiting if body.resting]
    parts = [(name, whole) for name, whole in wholes if whole and whole not in entities]
    return [
        *(f"{name}: a scene body that becomes an entity when it comes to rest" for name in moving),
        *(f"{name}: a part of {whole}, which is not an entity yet" for name, whole in parts),
    ]


def bodies_left_out(names: Collection[str]) -> list[str]:
    """Return the named bodies of the world that do not become entities."""
    if not names:
        return []
    only_parts = "is only a part of another" if len(names) == 1 else "are only parts of others"
    return [
        f"{wording.bodies(len(names))} of the world {only_parts}: {wording.few(names, 6)}"
        " (to have one, start with --class-map FILE)"
    ]


def describe_ghost(body: Body) -> str:
    """Return why a body does not collide, as a predicate."""
    return f"overlaps {body.in_the_way or 'another body'}, so it does not collide until there is room"
