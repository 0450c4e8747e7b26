"""Add, update, remove, clear: one entity, or those that are named."""

from __future__ import annotations

from semmap.nodes.coordinator import holding, transactions
from semmap.nodes.coordinator.authority import is_placing, require_authority
from semmap.nodes.coordinator.dialogues import Talk, ask
from semmap.nodes.coordinator.door.committing import changed, commit, new_id, once, taken_anew
from semmap.nodes.coordinator.door.jointed import require_opening
from semmap.nodes.coordinator.door.known_map import KnownMap
from semmap.nodes.coordinator.plausibility import doubts, require_carrying, require_same_nature
from semmap.nodes.coordinator.scene.hands import Hand
from semmap.nodes.coordinator.scene.settled import Settled, doing
from semmap.ontology import vocabulary as v
from semmap.ontology.name_index import Ambiguous, Named, NameIndex
from semmap.schemas import changes, errors, wording
from semmap.schemas.commands import (
    Add,
    Clear,
    Command,
    Infer,
    Properties,
    Remove,
    Set,
    Track,
    Unset,
    Update,
)
from semmap.schemas.commits import Effects, Transaction
from semmap.schemas.entities import ClassInfo, Entity, Pose, Value
from semmap.schemas.replies import Changed
from semmap.schemas.scene_files import pose_of

UNCHANGED = "unchanged: already up to date"
_TRIES = 4
"""How often a name is thought of anew: others may publish made-up commits one after another."""


@once
def add(view: KnownMap, command: Add) -> Talk[Changed]:
    """Add an entity to the map."""
    found = view.classes.spatial(command.class_)
    for _ in range(_TRIES):
        try:
            return (yield from _add(view, command, found))
        except errors.NameTaken:
            if command.name is not None:
                raise
        yield from taken_anew(view)  # it was not as it seemed: somebody published what was never committed
    return (yield from _add(view, command, found))


def _add(view: KnownMap, command: Add, found: ClassInfo) -> Talk[Changed]:
    name = command.name or view.free_name(found.name)
    if name in view.entities:
        raise errors.NameTaken(f"the name '{name}' is taken; see: semmap get {name}")
    at = command.at or ((0.0, 0.0, 0.0) if command.extent else view.free_place(command.size))
    pose = pose_of(at, command.yaw, command.orientation)
    ref = command.ref or (_label(found) if command.default else None)
    wanted = transactions.add(command, name, found, pose, ref)
    (new,) = wanted.add
    made = yield from commit(view, wanted)
    return changed(
        made,
        f"added {found.name} {name} at {_metres(new.pose or pose)}",
        names=(name,),
        notes=(
            *view.classes.note(command.class_, found),
            *doubts(name, found, pose if command.at else None, command.size, view.places),
        ),
    )


@once
def update(view: KnownMap, command: Update) -> Talk[Changed]:
    """Change an entity; omitted fields keep their values."""
    entity, found = updatable(view, command)
    made = yield from commit(view, transactions.update(command, entity, found))
    return changed(
        made,
        f"updated {_said(entity, made)}" if made else _said(entity, made),
        names=(entity.name, *(_others(made, entity.name) if command.carry else ())),
        notes=notes_on(view, command, entity, found, made),
    )


def updatable(view: KnownMap, command: Update) -> tuple[Entity, ClassInfo | None]:
    """The entity that is to be changed so, and the class that it is to have. Raises where it may not be."""
    entity = view.entity(command.name)
    require_opening(view, command)
    require_carrying(command)
    if command.source != "perception" and is_placing(command):
        holding.require_free(entity)
    found = view.classes.spatial(command.class_) if command.class_ is not None else None
    shape = (found, command.ref, command.alt, command.size, command.extent)
    if any(value is not None for value in shape):
        require_authority(command, [entity])
    require_same_nature(entity, found, force=command.force)
    return entity, found


def notes_on(
    view: KnownMap, command: Update, entity: Entity, found: ClassInfo | None, made: Effects | None
) -> tuple[str, ...]:
    """What is to be known of an entity that was changed so."""
    now = _after(made, entity.name) or entity
    return (
        *(view.classes.note(command.class_ or "", found) if found else ()),
        *doubts(
            entity.name,
            found or view.classes.by_name.get(entity.class_),
            now.pose if command.at else None,
            command.size,
            view.places,
        ),
    )


@once
def set_(view: KnownMap, command: Set) -> Talk[Changed]:
    """State a property of an entity."""
    require_opening(view, command)
    return (yield from _stated(view, command, transactions.state(command)))


@once
def unset(view: KnownMap, command: Unset) -> Talk[Changed]:
    """Take back what is stated by a property of an entity."""
    return (yield from _stated(view, command, transactions.unstate(command)))


def _stated(view: KnownMap, command: Set | Unset, transaction: Transaction) -> Talk[Changed]:
    entity = view.entity(command.name)
    made = yield from commit(view, transaction)
    text = _said(entity, made) if made else f"{entity.name}: {(yield from _as_it_is(entity, command))}"
    return changed(made, text, names=(entity.name,))


def _as_it_is(entity: Entity, command: Set | Unset) -> Talk[str]:
    """What is stated by a property that a command did not change."""
    known = NameIndex(
        Named(p.name, p.iri, labels=tuple(p.labels.values())) for p in (yield from ask(Properties()))
    )
    try:
        name = known.find(command.property) or command.property
    except Ambiguous:
        return UNCHANGED
    stated = entity.properties.get(name)
    is_ = "not set" if stated is None else changes.stated_in_words(stated)
    if isinstance(command, Unset) and (value := (yield from _inferred(entity, name, command.value))):
        is_ += f", but {value} follows; for the reason: semmap explain {entity.name} {name} {value}"
    return f"unchanged: {name} is {is_}"


def _inferred(entity: Entity, property_: str, wanted: Value | None) -> Talk[str | None]:
    """A value that follows, the one that is wanted or the first."""
    inferred = yield from ask(Infer(name=entity.name))
    found = [o for _, p, o in inferred.triples if v.local_name(p) == property_ and o.startswith("<")]
    values = map(v.entity_name, found)
    return next((value for value in values if wanted in (None, value)), None)


def _said(was: Entity, made: Effects | None) -> str:
    """What a commit has changed of an entity, in words."""
    now = _after(made, was.name)
    if made is None:
        return f"{was.name}: {UNCHANGED}"
    said = changes.in_words(changes.between(was, now)) if now is not None else ""
    return f"{was.name}: {said}" if said else was.name


def _others(made: Effects | None, name: str) -> tuple[str, ...]:
    """The other entities that a commit changes: those that were carried along."""
    return tuple(e.name for e in made.changed if e.name != name) if made is not None else ()


def _after(made: Effects | None, name: str) -> Entity | None:
    """The entity as a commit leaves it, if it changes it."""
    return next((e for e in made.changed if e.name == name), None) if made is not None else None


@once
def track(view: KnownMap, command: Track) -> Talk[Changed]:
    """Let an entity's pose come live, or no more. Raises Refused for a place."""
    entity = view.entity(command.name)
    if entity.place:
        raise errors.Refused(f"{entity.name} is a place, which stays where it is; track what moves")
    made = yield from commit(view, transactions.track(command))
    if made is None:
        source = "the simulator" if entity.tracked == "sim" else "a stream of poses"
        now = f"is tracked from {source} already" if entity.tracked else "is not tracked"
        return changed(None, f"unchanged: {entity.name} {now}", names=(entity.name,))
    return changed(made, _said(entity, made), names=(entity.name,))


@once
def remove(view: KnownMap, command: Remove) -> Talk[Changed]:
    """Take entities out: all of them, or, if one is unknown, none."""
    if not command.names:
        raise errors.BadRequest("name at least one entity to remove")
    leaving = [view.entity(name) for name in dict.fromkeys(command.names)]
    require_authority(command, leaving)
    holding.require_empty_handed(command.names, view.held)
    return (yield from _take_out(view, command, f"remove {' '.join(e.name for e in leaving)}", leaving))


@once
def clear(view: KnownMap, command: Clear) -> Talk[Changed]:
    """Take every entity out."""
    require_authority(command, view.entities.values())
    return (yield from _take_out(view, command, "clear", list(view.entities.values())))


def follow(view: KnownMap, settled: Settled, hand: Hand) -> Talk[Changed]:
    """The map takes over where bodies came to rest, in one commit: those that nobody has moved meanwhile."""
    edits = settled.edits(view.entities)
    if not edits:
        return changed(None, UNCHANGED)
    reason = settled.reason or (hand.reason if hand.verb or not settled.joints else _of_joints(view, settled))
    moved = Transaction(
        id=new_id(),
        source=settled.source,
        agent=hand.agent,
        verb=hand.verb,
        reason=reason,
        edit=tuple(edits),
    )
    made = yield from commit(view, moved)
    return changed(made, reason, names=tuple(edit.name for edit in edits))


def _of_joints(view: KnownMap, settled: Settled) -> str:
    return "; ".join(
        f"{name} {doing(joints, view.entities[name].properties)} in the scene"
        for name, joints in settled.joints.items()
        if name in view.entities
    )


def _take_out(view: KnownMap, command: Command, reason: str, leaving: list[Entity]) -> Talk[Changed]:
    names = tuple(entity.name for entity in leaving)
    if not names:
        return Changed(commit=None, text="the map is already empty")
    made = yield from commit(view, transactions.remove(command, reason, names))
    return changed(made, f"removed {len(names)}: {wording.few(names)}", names=names)


def _label(found: ClassInfo) -> str:
    return found.labels.get("en") or found.labels.get("") or found.name.replace("_", " ").lower()


def _metres(pose: Pose) -> str:
    return "({:g}, {:g}, {:g})".format(*pose.position_m)
