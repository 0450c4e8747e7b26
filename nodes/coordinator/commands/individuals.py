"""Changes of individuals that are not in space: the coordinator's replica of the map does not have them."""

from __future__ import annotations

from contextlib import suppress

from semmap.nodes.coordinator.commands import transactions
from semmap.nodes.coordinator.commands.commit import commit, make_reply
from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.nodes.coordinator.kb_coroutines import KbCoroutine, ask
from semmap.schemas import changes, errors
from semmap.schemas.commands import Get, Rename
from semmap.schemas.commits import Edit, Transaction
from semmap.schemas.entities import Entity
from semmap.schemas.relations import Described
from semmap.schemas.replies import Changed


def find_individual(view: MapView, word: str) -> KbCoroutine[Entity]:
    """Return the individual with this name or IRI, or the entity with this IRI.

    Raises UnknownName, also for labels and classes of entities; BadRequest for a name of several individuals.
    """
    found: Described | None = None
    with suppress(errors.UnknownName):
        found = yield from ask(Get(name=word))
    if found is not None and not found.in_space:
        return found
    is_iri = found is not None and found.iri == word.removeprefix("<").removesuffix(">")
    return view.entity(found.name if found is not None and is_iri else word)


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


def change_individual(view: MapView, was: Entity, transaction: Transaction) -> KbCoroutine[Changed]:
    """Commit a change of properties of an individual, and return what has changed."""
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
