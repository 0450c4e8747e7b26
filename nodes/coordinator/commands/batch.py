"""Handler of a batch: several changes of entities in one commit, all or none."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final, NamedTuple

from msgspec import structs

from semmap.nodes.coordinator.commands import transactions
from semmap.nodes.coordinator.commands.commit import commit, make_reply
from semmap.nodes.coordinator.commands.entity_changes import UNCHANGED, notes_for, resolve_update
from semmap.nodes.coordinator.commands.individuals import find_meant
from semmap.nodes.coordinator.commands.joint_state import normalize_property, properties_in, require_openable
from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.nodes.coordinator.commands.registration import handles
from semmap.nodes.coordinator.kb_coroutines import KbCoroutine
from semmap.schemas import errors, wording
from semmap.schemas.commands import Batch, Command, Set, Unset, Update
from semmap.schemas.commits import Effects, Transaction
from semmap.schemas.entities import ClassInfo, Entity
from semmap.schemas.replies import Changed

_OF_ALL: Final = (
    *("id", "source", "agent", "reason"),
    *("confidence", "unchanged", "since", "dry_run"),
)
"""Fields that are given once for the batch, not for a change in it."""
_NOT_HERE: Final = ("wait", "frame", "on", "in_", "next_to")
_DEFAULTS: Final = {name: getattr(Update(name="_"), name) for name in (*_OF_ALL, *_NOT_HERE)}


_Change = Update | Set | Unset


class _Wanted(NamedTuple):
    """One change of a batch."""

    change: _Change
    entity: Entity
    found: ClassInfo | None
    """The new class of the entity, if it changes."""
    transaction: Transaction


@handles(Batch)
def batch(view: MapView, command: Batch) -> KbCoroutine[Changed]:
    """Make all changes, or none. Raises the error of the first change that is rejected."""
    if not command.changes:
        raise errors.BadRequest("the batch has no changes; give an update, a set or an unset")
    changes: list[_Change] = []
    for change in command.changes:
        _require_bare(change)
        name = yield from _find_name(view, change)
        changes.append(structs.replace(change, name=name, source=command.source, agent=command.agent))
    _require_each_once(changes)
    wanted = [_wanted(view, change) for change in changes]
    made = yield from commit(view, transactions.combine(command, [one.transaction for one in wanted]))
    names = tuple(dict.fromkeys(one.entity.name for one in wanted))
    return make_reply(
        made, _describe(names, made), names=names, notes=tuple(dict.fromkeys(_notes(view, wanted, made)))
    )


def _find_name(view: MapView, change: _Change) -> KbCoroutine[str]:
    """Return the name of the entity of a change. Raises Refused for an individual that is not in space."""
    found = yield from find_meant(view, change.name, by_label=not isinstance(change, Update))
    if not found.in_space:
        raise errors.Refused(
            f"{found.name} is not in space, and a batch changes only entities; use:"
            f" semmap {change.VERB} {found.name}"
        )
    return found.name


def _wanted(view: MapView, change: _Change) -> _Wanted:
    if isinstance(change, Update):
        entity, found = resolve_update(view, change)
        return _Wanted(change, entity, found, transactions.update(change, entity, found))
    if isinstance(change, Set):
        require_openable(view, change)
        return _Wanted(change, view.entity(change.name), None, transactions.set_property(change))
    return _Wanted(change, view.entity(change.name), None, transactions.unset_property(change))


def _notes(view: MapView, wanted: list[_Wanted], made: Effects | None) -> list[str]:
    return [
        note
        for one in wanted
        if isinstance(one.change, Update)
        for note in notes_for(view, one.change, one.entity, one.found, made)
    ]


def _describe(names: tuple[str, ...], made: Effects | None) -> str:
    if made is None:
        return UNCHANGED
    touched = {entity.name for entity in made.changed}
    unchanged = [name for name in names if name not in touched]
    done = [name for name in names if name in touched]
    also = f"; already so: {wording.few(unchanged)}" if unchanged else ""
    return f"changed {len(done)}: {wording.few(done)}{also}"


def _require_each_once(changes: Iterable[_Change]) -> None:
    """Raise BadRequest if two changes affect the same property, because all changes happen together."""
    known: set[tuple[str, str]] = set()
    for change in changes:
        touched = {(change.name, normalize_property(word)): word for word in _words(change)}
        if isinstance(change, Update):
            touched[change.name, ""] = ""
        if twice := touched.keys() & known:
            word = touched[min(twice)]
            what = f"{word} of {change.name}" if word else change.name
            raise errors.BadRequest(
                f"the batch changes {what} twice, but all its changes happen together; use one change"
            )
        known |= touched.keys()


def _words(change: _Change) -> tuple[str, ...]:
    """Return the properties that a change affects, as they are written."""
    if not isinstance(change, Update):
        return (change.property,)
    return properties_in((*change.set, *change.unset))


def _require_bare(change: Command) -> None:
    """Raise BadRequest for a change with a field that belongs to the batch, or is not possible in one."""
    given = [name for name, usual in _DEFAULTS.items() if getattr(change, name, usual) != usual]
    if misplaced := [name for name in given if name in _OF_ALL]:
        raise errors.BadRequest(f"give {wording.few(misplaced)} once for the batch, not for a change in it")
    if "frame" in given:
        raise errors.BadRequest("positions in a batch are in the map frame; remove the frame")
    if given and given != ["wait"]:
        raise errors.BadRequest("a change in a batch is placed by its position; give at")
    if given:
        raise errors.BadRequest("a batch does not wait for bodies; remove wait")
