"""Handlers that change entities: add, update, set, unset, rename, track, remove, clear."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from msgspec import structs

from semmap.nodes.coordinator.access.authority import is_placing, require_authority
from semmap.nodes.coordinator.commands import attachment_rules, individuals, transactions
from semmap.nodes.coordinator.commands.commit import commit, make_reply, new_id, reload_map
from semmap.nodes.coordinator.commands.joint_state import require_openable
from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.nodes.coordinator.commands.placement import place
from semmap.nodes.coordinator.commands.plausibility import (
    find_doubtful_name,
    find_doubts,
    require_carry,
    require_same_nature,
)
from semmap.nodes.coordinator.commands.registration import handles
from semmap.nodes.coordinator.kb_coroutines import KbCoroutine, ask
from semmap.nodes.coordinator.reconciler.observed_state import ObservedState, describe_joint_change
from semmap.nodes.coordinator.scene.manual_moves import Attribution
from semmap.ontology import vocabulary as v
from semmap.ontology.name_index import Ambiguous, Named, NameIndex
from semmap.schemas import changes, errors, wording
from semmap.schemas.attachments import holder_of
from semmap.schemas.commands import (
    Add,
    Clear,
    Command,
    Infer,
    Properties,
    Remove,
    Rename,
    Set,
    Track,
    Unset,
    Update,
)
from semmap.schemas.commits import Edit, Effects, Transaction
from semmap.schemas.entities import ClassInfo, Entity, Pose, Value
from semmap.schemas.replies import Changed
from semmap.schemas.scene_files import pose_of
from semmap.schemas.scenes import Body

UNCHANGED = "unchanged: already up to date"
_TRIES = 4
"""How often another name is tried if a generated name turns out to be taken."""


@handles(Add)
def add(view: MapView, command: Add) -> KbCoroutine[Changed]:
    """Add an entity to the map."""
    found = _find_class(view, command)
    for _ in range(_TRIES):
        try:
            return (yield from _add(view, command, found))
        except errors.NameTaken:
            if command.name is not None:
                raise
        yield from reload_map(view)  # the replica was wrong: it had a publication that was never committed
    return (yield from _add(view, command, found))


def _find_class(view: MapView, command: Add) -> ClassInfo:
    """Return the class of a new entity. Raises UnknownClass, also if class and name were swapped."""
    try:
        return view.classes.spatial(command.class_)
    except errors.UnknownClass as error:
        if command.name is None or not view.classes.has(command.name):
            raise
        raise errors.UnknownClass(
            f"{error.text.partition(';')[0]}; the class comes before the name:"
            f" semmap add {command.name} {command.class_}"
        ) from None


def _add(view: MapView, command: Add, found: ClassInfo) -> KbCoroutine[Changed]:
    name = command.name or view.free_name(found.name)
    if name in view.entities:
        raise errors.NameTaken(f"the name '{name}' is taken; see: semmap get {name}")
    command, where, notes = yield from place(view, command, name, found)
    at = command.at or ((0.0, 0.0, 0.0) if command.extent else view.free_place(command.size))
    pose = pose_of(at, command.yaw, command.orientation)
    ref = command.ref or (_label(found) if command.default else None)
    wanted = transactions.add(command, name, found, pose, ref)
    (new,) = wanted.add
    made = yield from commit(view, wanted)
    return make_reply(
        made,
        f"added {found.name} {name}{where} at {_format_position(new.pose or pose)}",
        names=(name,),
        notes=(
            *notes,
            *view.classes.note(command.class_, found),
            *find_doubtful_name(name),
            *find_doubts(name, found, pose if command.at else None, command.size, view.places),
        ),
    )


@handles(Update)
def update(view: MapView, command: Update) -> KbCoroutine[Changed]:
    """Change an entity, or an individual that is not in space; omitted fields keep their values."""
    known = yield from individuals.find_meant(view, command.name)
    if not known.in_space:
        return (yield from individuals.update_individual(view, known, command))
    command = structs.replace(command, name=known.name)
    entity, found = resolve_update(view, command)
    command, where, notes = yield from place(view, command, entity.name, found)
    made = yield from commit(view, transactions.update(command, entity, found))
    return make_reply(
        made,
        f"updated {_describe(entity, made)}{where and f',{where}'}" if made else _describe(entity, made),
        names=(entity.name, *(_other_names(made, entity.name) if command.carry else ())),
        notes=(*notes, *notes_for(view, command, entity, found, made)),
    )


def resolve_update(view: MapView, command: Update) -> tuple[Entity, ClassInfo | None]:
    """Return the entity to update, and its new class if it changes. Raises if the update is not allowed."""
    entity = view.entity(command.name)
    require_openable(view, command)
    require_carry(command)
    if command.source != "perception" and is_placing(command):
        attachment_rules.require_detached(entity)
    found = view.classes.spatial(command.class_) if command.class_ is not None else None
    shape = (found, command.ref, command.alt, command.size, command.extent)
    if any(value is not None for value in shape):
        require_authority(command, [entity])
    require_same_nature(entity, found, force=command.force)
    return entity, found


def notes_for(
    view: MapView, command: Update, entity: Entity, found: ClassInfo | None, made: Effects | None
) -> tuple[str, ...]:
    """Return the notes about an updated entity."""
    now = _find_changed(made, entity.name) or entity
    return (
        *(view.classes.note(command.class_ or "", found) if found else ()),
        *find_doubts(
            entity.name,
            found or view.classes.by_name.get(entity.class_),
            now.pose if command.at else None,
            command.size,
            view.places,
        ),
    )


@handles(Set)
def set_(view: MapView, command: Set) -> KbCoroutine[Changed]:
    """Set a property of an entity, or of an individual that is not in space."""
    return (yield from _change_property(view, command))


@handles(Unset)
def unset(view: MapView, command: Unset) -> KbCoroutine[Changed]:
    """Remove the values of a property of an entity, or one of them."""
    return (yield from _change_property(view, command))


def _change_property(view: MapView, command: Set | Unset) -> KbCoroutine[Changed]:
    entity = yield from individuals.find_meant(view, command.name, by_label=True)
    if entity.in_space:
        command = structs.replace(command, name=entity.name)
    if isinstance(command, Set):
        require_openable(view, command)
        transaction = transactions.set_property(command)
    else:
        transaction = transactions.unset_property(command)
    if not entity.in_space:
        return (yield from individuals.change_individual(view, entity, transaction))
    made = yield from commit(view, transaction)
    text = (
        _describe(entity, made) if made else f"{entity.name}: {(yield from _describe_value(entity, command))}"
    )
    return make_reply(made, text, names=(entity.name,))


def _describe_value(entity: Entity, command: Set | Unset) -> KbCoroutine[str]:
    """Return in words the value of a property that a command has not changed."""
    known = NameIndex(
        Named(p.name, p.iri, labels=tuple(p.labels.values())) for p in (yield from ask(Properties()))
    )
    try:
        name = known.find(command.property) or command.property
    except Ambiguous:
        return UNCHANGED
    stated = entity.properties.get(name)
    is_ = "not set" if stated is None else changes.stated_in_words(stated)
    if isinstance(command, Unset) and (value := (yield from _find_inferred(entity, name, command.value))):
        is_ += f", but {value} is inferred; for the reason: semmap explain {entity.name} {name} {value}"
    return f"unchanged: {name} is {is_}"


def _find_inferred(entity: Entity, property_: str, wanted: Value | None) -> KbCoroutine[str | None]:
    """Return an inferred value: the wanted one or the first."""
    inferred = yield from ask(Infer(name=entity.name))
    found = [o for _, p, o in inferred.triples if v.local_name(p) == property_ and o.startswith("<")]
    values = map(v.entity_name, found)
    return next((value for value in values if wanted in (None, value)), None)


def _describe(was: Entity, made: Effects | None) -> str:
    """Return in words what a commit has changed of an entity."""
    now = _find_changed(made, was.name)
    if made is None:
        return f"{was.name}: {UNCHANGED}"
    text = changes.in_words(changes.between(was, now)) if now is not None else ""
    return f"{was.name}: {text}" if text else was.name


def _other_names(made: Effects | None, name: str) -> tuple[str, ...]:
    """Return the other entities that a commit has changed: those that were carried along."""
    return tuple(e.name for e in made.changed if e.name != name) if made is not None else ()


def _find_changed(made: Effects | None, name: str) -> Entity | None:
    """Return the entity after a commit, if the commit changes it."""
    return next((e for e in made.changed if e.name == name), None) if made is not None else None


@handles(Rename)
def rename(view: MapView, command: Rename) -> KbCoroutine[Changed]:
    """Rename an entity, or an individual that is not in space.

    Raises Refused if its name is fixed by something else, NameTaken.
    """
    entity = yield from individuals.find_meant(view, command.name)
    if command.new == entity.name:
        return make_reply(None, f"unchanged: the name is already {entity.name}", names=(entity.name,))
    if command.new in view.entities:
        raise errors.NameTaken(f"the name '{command.new}' is taken; see: semmap get {command.new}")
    require_authority(command, [entity])
    if not entity.in_space:
        return (yield from individuals.rename_individual(view, entity, command))
    _require_renamable(view, entity)
    reason = f"rename {entity.name} to {command.new}"
    renaming = Edit(name=entity.name, rename=command.new)
    made = yield from commit(view, transactions.build(command, reason, edit=[renaming]))
    now = _find_changed(made, command.new)
    notes = find_doubtful_name(command.new)
    if now is not None and now.model != entity.model:
        notes = (
            *notes,
            f"the model of its body follows its name: {now.model} instead of {entity.model}",
        )
    return make_reply(made, f"renamed {entity.name} to {command.new}", names=(command.new,), notes=notes)


def _require_renamable(view: MapView, entity: Entity) -> None:
    """Raise Refused for a robot, a body of the world file, and for a tracked or attached entity."""
    name, body = entity.name, view.bodies().get(entity.name)
    is_robot = "Robot" in entity.types or (body is not None and body.robot)
    if is_robot or (body is not None and (body.part_of or not body.entity)):
        is_ = "a robot or a part of one" if is_robot else "a body of the world file"
        raise errors.Refused(
            f"{name} is {is_}, so its name is fixed; to label it: semmap update {name} --ref TEXT"
        )
    if entity.tracked:
        raise errors.Refused(f"{name} is tracked; to rename it, first: semmap track {name} --off")
    if by := holder_of(entity):
        raise errors.Refused(f"{name} is attached to {by}; to rename it, first: semmap detach {name}")
    attachment_rules.require_no_attachments((name,), view.held)


@handles(Track)
def track(view: MapView, command: Track) -> KbCoroutine[Changed]:
    """Start or stop tracking an entity. Raises Refused for a place."""
    entity = view.entity(command.name)
    if entity.place:
        raise errors.Refused(f"{entity.name} is a place and does not move; only objects can be tracked")
    made = yield from commit(view, transactions.track(command))
    if made is None:
        source = "the simulator" if entity.tracked == "sim" else "a stream of poses"
        now = f"is tracked from {source} already" if entity.tracked else "is not tracked"
        return make_reply(None, f"unchanged: {entity.name} {now}", names=(entity.name,))
    return make_reply(made, _describe(entity, made), names=(entity.name,))


@handles(Remove)
def remove(view: MapView, command: Remove) -> KbCoroutine[Changed]:
    """Remove entities: all of them, or none if one is unknown."""
    if not command.names:
        raise errors.BadRequest("name at least one entity to remove")
    found = dict[str, Entity]()
    for word in command.names:
        entity = yield from individuals.find_meant(view, word)
        found[entity.iri] = entity
    leaving = [*found.values()]
    require_authority(command, leaving)
    attachment_rules.require_no_attachments([e.name for e in leaving if e.in_space], view.held)
    return (yield from _remove(view, command, f"remove {' '.join(e.name for e in leaving)}", leaving))


def require_removable(names: Iterable[str], bodies: Mapping[str, Body]) -> None:
    """Raise Refused for a robot of the simulator, or a part of one: it would be added again."""
    for name in names:
        if (body := bodies.get(name)) is not None and body.robot:
            whole = f"part of {body.part_of}, a" if body.part_of else "the"
            raise errors.Refused(
                f"{name} is {whole} robot of the simulator, so it would be added again;"
                " to remove it, first restart without --robot: semmap up"
            )


@handles(Clear)
def clear(view: MapView, command: Clear) -> KbCoroutine[Changed]:
    """Remove all entities, and what is asserted about other individuals."""
    leaving = tuple(view.entities.values())
    require_authority(command, leaving)
    names = tuple(entity.name for entity in leaving)
    made = yield from commit(view, transactions.clear(command, names))
    if made is None:
        return Changed(commit=None, text="the map is already empty")
    text = f"removed {len(names)}: {wording.few(names)}" if names else "removed all non-spatial individuals"
    return make_reply(made, text, names=names)


def adopt_observed(view: MapView, observed: ObservedState, cause: Attribution) -> KbCoroutine[Changed]:
    """Commit the state of bodies at rest in one commit, except of those that were changed since."""
    edits = observed.edits(view.entities)
    if not edits:
        return make_reply(None, UNCHANGED)
    reason = observed.reason or (
        cause.reason if cause.verb or not observed.joints else _describe_joints(view, observed)
    )
    moved = Transaction(
        id=new_id(),
        source=observed.source,
        agent=cause.agent,
        verb=cause.verb,
        reason=reason,
        edit=tuple(edits),
    )
    made = yield from commit(view, moved)
    return make_reply(made, reason, names=tuple(edit.name for edit in edits))


def _describe_joints(view: MapView, observed: ObservedState) -> str:
    return "; ".join(
        f"{name} {describe_joint_change(joints, view.entities[name].properties)} in the scene"
        for name, joints in observed.joints.items()
        if name in view.entities
    )


def _remove(view: MapView, command: Command, reason: str, leaving: list[Entity]) -> KbCoroutine[Changed]:
    names = tuple(entity.name for entity in leaving)
    given = [entity.name if entity.in_space else f"<{entity.iri}>" for entity in leaving]
    made = yield from commit(view, transactions.remove(command, reason, given))
    return make_reply(made, f"removed {len(names)}: {wording.few(names)}", names=names)


def _label(found: ClassInfo) -> str:
    return found.labels.get("en") or found.labels.get("") or found.name.replace("_", " ").lower()


def _format_position(pose: Pose) -> str:
    return "({:g}, {:g}, {:g})".format(*pose.position_m)
