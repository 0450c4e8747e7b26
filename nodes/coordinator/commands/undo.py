"""Handler of undo: the knowledge base decides which commits are undone together."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from semmap.nodes.coordinator.commands.commit import apply_with_classes, make_reply
from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.nodes.coordinator.commands.registration import handles
from semmap.nodes.coordinator.kb_coroutines import KbCoroutine, ask
from semmap.schemas import changes, errors, wording
from semmap.schemas.bridge import TakeBack
from semmap.schemas.changes import Change
from semmap.schemas.commands import Undo
from semmap.schemas.commits import Effects
from semmap.schemas.entities import Entity
from semmap.schemas.replies import Changed

_FEW: Final = 50
"""Largest number of changes in the reply."""
_NAMED: Final = 3
"""Largest number of changes in its text."""
_VERBS: Final = frozenset(("moved", "turned", "tilted", "placed", "added", "removed"))


@handles(Undo)
def undo(view: MapView, command: Undo) -> KbCoroutine[Changed]:
    """Undo a commit."""
    commit = yield from ask(
        TakeBack(
            id=command.id,
            source=command.source,
            agent=command.agent,
            reason=command.reason,
            commit=command.commit,
            dry_run=command.dry_run,
            told=True,
        )
    )
    if commit is None:  # a dry run of what was done before
        return Changed(commit=None, text="nothing is left to undo")
    if not commit.undoes:
        raise errors.Refused(
            f"the id '{command.id}' belongs to commit {commit.seq}, which is not an undo;"
            " use a different id for each command"
        )
    first, *settling = commit.undoes
    undone = _changes_of(view.entities, commit)
    yield from apply_with_classes(view, commit)
    text = f"undid commit {first}"
    if settling:
        text += f" and what settled after it ({wording.commits(settling)})"
    if described := _describe(undone, commit):
        text = f"{text}: {described}"
    return make_reply(commit, text, names=commit.names, undone=undone)


def _changes_of(before: Mapping[str, Entity], undoing: Effects) -> tuple[Change, ...]:
    """Return what the undone commits had changed, of the first entities: from after the undo to before it."""
    found: list[Change] = []
    earlier = {was: now for now, was in undoing.renamed.items()}
    for gone in undoing.removed[:_FEW]:
        if gone.name not in earlier and (was := before.get(gone.name)) is not None:
            found += changes.between(None, was)
    for entity in undoing.changed[:_FEW]:
        if (was := before.get(undoing.renamed.get(entity.name, entity.name))) is None:
            found.append(changes.removed(entity.name, entity.class_))
        else:
            found += changes.between(entity, was)
    return tuple(found[:_FEW])


def _describe(undone: tuple[Change, ...], undoing: Effects) -> str:
    """Return the changes in words: the first ones, or the commit's reason where they are not known."""
    if not undone:
        return undoing.reason.partition(": ")[2]
    words = [_sentence(change) for change in undone[:_NAMED]]
    count = len({*undoing.names} - undoing.renamed.keys() - {change.name for change in undone[:_NAMED]})
    return "; ".join(words) + (f"; … and {wording.entities(count)} more" if count > 0 else "")


def _sentence(change: Change) -> str:
    """`moved chair1 from (1, 2, 0) to (2, 2, 0)`; `fridge1: isOpen: false → true`."""
    if change.kind == "name":
        return f"renamed {change.was} to {change.now}"
    verb, _, rest = change.text.partition(" ")
    if change.kind in ("pose", "added", "removed") and verb in _VERBS:
        return f"{verb} {change.name} {rest}".rstrip()
    return f"{change.name}: {change.text}"
