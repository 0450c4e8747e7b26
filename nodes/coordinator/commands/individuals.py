"""Changes of individuals that are not in space: the coordinator's replica of the map does not have them."""

from __future__ import annotations

from contextlib import suppress
from typing import Final

from msgspec import structs

from semmap.nodes.coordinator.access.authority import require_authority
from semmap.nodes.coordinator.commands import transactions
from semmap.nodes.coordinator.commands.commit import commit, make_reply
from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.nodes.coordinator.kb_coroutines import KbCoroutine, ask
from semmap.schemas import changes, errors
from semmap.schemas.commands import Get, Rename, Update
from semmap.schemas.commits import Edit, Transaction
from semmap.schemas.entities import Entity, composed
from semmap.schemas.relations import Described
from semmap.schemas.replies import Changed

_OF_SPACE: Final = {
    name: getattr(Update(name="_"), name)
    for name in (
        *("at", "yaw", "orientation", "frame", "size", "extent", "on", "in_", "next_to"),
        *("carry", "leave", "conflict", "wait"),
    )
}
"""The fields of an update that only entities have, with their defaults."""


def find_meant(view: MapView, word: str, *, by_label: bool = False) -> KbCoroutine[Entity]:
    """Return the entity or individual that a word of a command means: the one with this name or IRI.

    With `by_label`, also the only one with this label or class. Changes of names, labels and classes do not
    use it, because these differ afterwards, and neither does a removal.

    Raises UnknownName; BadRequest for a word of several.
    """
    if word in view.entities:
        return view.entities[word]
    try:
        found: Described = yield from ask(Get(name=word))
    except errors.UnknownName:
        if by_label:
            raise
        return view.entity(word)  # raises it with the names of that label
    if not (by_label or _is_named(found, word)):
        return view.entity(word)
    return view.entity(found.name) if found.in_space else found


def _is_named(found: Entity, word: str) -> bool:
    """Return whether a word is a name or the IRI of what was found by it, and not its label or class."""
    _, colon, local = word.rpartition(":")
    is_prefixed = bool(colon and local) and found.iri.endswith(local)
    return is_prefixed or composed(word) in (found.name, *found.other_names, found.iri, f"<{found.iri}>")


def rename_individual(view: MapView, was: Entity, command: Rename) -> KbCoroutine[Changed]:
    """Commit another last part of the IRI of an individual. Raises NameTaken."""
    try:
        found: Described | None = yield from ask(Get(name=command.new))
    except errors.UnknownName:
        found = None
    except errors.BadRequest:  # several individuals have it
        raise errors.NameTaken(
            f"several individuals have the name '{command.new}'; give another name"
        ) from None
    if found is not None and found.name == command.new:
        raise errors.NameTaken(f"the name '{command.new}' is taken; see: semmap get {command.new}")
    reason = f"rename {was.name} to {command.new}"
    renaming = Edit(name=f"<{was.iri}>", rename=command.new)
    made = yield from commit(view, transactions.build(command, reason, edit=[renaming]))
    return make_reply(made, f"renamed {was.name} to {command.new}", names=(command.new,))


def update_individual(view: MapView, was: Entity, command: Update) -> KbCoroutine[Changed]:
    """Commit a new class, labels and properties of an individual.

    Raises Refused for a pose, a size and the like, and for a class of things in space.
    """
    if given := [name for name, usual in _OF_SPACE.items() if getattr(command, name) != usual]:
        options = " ".join(f"--{name.rstrip('_').replace('_', '-')}" for name in given)
        raise errors.Refused(
            f"{was.name} is not in space, so only its class, labels and properties can be updated;"
            f" remove {options}"
        )
    found = None if command.class_ is None else view.classes.find(command.class_)
    if found is not None and found.spatial:
        raise errors.Refused(
            f"{was.name} is not in space, and {found.name} is a class of things in space; for a new entity of"
            f" it: semmap add {found.name}"
        )
    if (command.class_, command.ref, command.alt) != (None, None, None):
        require_authority(command, [was])
    made = yield from change_individual(view, was, transactions.update(command, was, found))
    notes = view.classes.note(command.class_ or "", found) if found is not None else ()
    return structs.replace(made, notes=(*made.notes, *notes))


def change_individual(view: MapView, was: Entity, transaction: Transaction) -> KbCoroutine[Changed]:
    """Commit a change of an individual, and return what has changed."""
    given = f"<{was.iri}>"
    made = yield from commit(view, transactions.for_name(transaction, given))
    if made is None:
        return make_reply(None, f"{was.name}: unchanged: already up to date", names=(was.name,))
    text = ""
    if made.trial is None:
        with suppress(errors.UnknownName):  # after its last value was unset, it is not described any more
            now = yield from ask(Get(name=given))
            text = changes.in_words(changes.between(was, now))
    return make_reply(made, f"{was.name}: {text or transaction.reason}", names=(was.name,))
