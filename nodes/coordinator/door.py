"""The door: a command in, a transaction to the knowledge base, a reply out.

It validates, resolves names, and leaves consistency to the knowledge base. It knows no Zenoh: what it
asks of the knowledge base goes through the functions that it is given.
"""

from __future__ import annotations

import functools
import uuid
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TypeVar

from msgspec import structs

from nodes.coordinator import transactions
from nodes.coordinator.authority import require_authority, require_operator
from nodes.coordinator.class_names import ClassNames
from nodes.coordinator.files import huric
from nodes.coordinator.files.content import kind_of
from nodes.coordinator.hands import Hands
from nodes.coordinator.naming import free_position
from nodes.coordinator.talking import Ask, Question, Talk, hold, hold_all
from schemas import errors, scene_files
from schemas.bridge import LoadDocument, Loaded, LoadTBox, StarQuery
from schemas.commands import Add, Changed, Classes, Clear, Command, Load, Remove, Undo, Update
from schemas.commits import Commit, Snapshot, Star, Transaction
from schemas.entities import ClassInfo, Entity, Pose, free_name
from schemas.explanations import Triple
from schemas.scene_files import Described, pose_of

READERS: Mapping[str, Callable[[bytes, str], tuple[Described, ...]]] = {
    "scene": scene_files.read,
    "huric": huric.read,
}
_ATTEMPTS = 5


D = TypeVar("D", bound="Door")
C = TypeVar("C", bound=Command)


def once(change: Callable[[D, C], Talk[Changed]]) -> Callable[[D, C], Talk[Changed]]:
    """A command that is sent again under the same id is answered with its first result."""

    @functools.wraps(change)
    def execute(door: D, command: C) -> Talk[Changed]:
        if not command.id:
            return (yield from change(door, structs.replace(command, id=_new_id())))
        done: Changed | None = yield from door.done_before(command)
        return done or (yield from change(door, command))

    return execute


class Door:
    """Executes the commands that change the map. Owned by the coordinator's thread."""

    def __init__(self, ask: Ask) -> None:
        """`ask(verb, message)` asks the knowledge base."""
        self._ask = ask
        self.classes = ClassNames()
        self.entities: dict[str, Entity] = {}
        self.seq = 0
        self.hands = Hands()

    def entity(self, name: str) -> Entity:
        """The entity of that name. Raises UnknownName with the nearest ones."""
        if name in self.entities:
            return self.entities[name]
        raise errors.UnknownName(f"no entity is named '{name}'{errors.did_you_mean(name, self.entities)}")

    def begin(self, snapshot: Snapshot) -> None:
        """Take over a snapshot, unless it is older than what is known."""
        if snapshot.seq >= self.seq:
            self.seq = snapshot.seq
            self.entities = {entity.name: entity for entity in snapshot.entities}

    def take(self, commit: Commit) -> bool:
        """Show a commit in `entities`. False when one before it was missed, so that a snapshot is needed."""
        if commit.seq <= self.seq:
            return True
        if commit.seq != self.seq + 1:
            return False
        self.seq = commit.seq
        for gone in commit.removed:
            self.entities.pop(gone.name, None)
        self.entities.update({entity.name: entity for entity in commit.changed})
        return True

    def add(self, command: Add) -> Changed:
        """Put an entity into the map."""
        return hold(self._add(command), self._ask)

    def update(self, command: Update) -> Changed:
        """Change what is named; what is not named stays."""
        return hold(self._update(command), self._ask)

    def change_together(self, commands: Sequence[Add | Update]) -> list[Changed | errors.SemmapError]:
        """Like `add` and `update` one after the other, with fewer questions to the knowledge base."""
        return [
            result
            for group in _independent(commands)
            for result in hold_all([self._changing(command) for command in group], self._ask)
        ]

    def remove(self, command: Remove) -> Changed:
        """Take entities out: all of them, or, if one is unknown, none."""
        return hold(self._remove(command), self._ask)

    def clear(self, command: Clear) -> Changed:
        """Take every entity out."""
        return hold(self._clear(command), self._ask)

    def load(self, command: Load) -> Changed:
        """Add what a file describes."""
        return hold(self._load(command), self._ask)

    def undo(self, command: Undo) -> Changed:
        """Take back a commit."""
        return hold(self._undo(command), self._ask)

    def follow(self, name: str, pose: Pose) -> None:
        """The map takes over where a body came to rest. Raises what the knowledge base refuses."""
        hand = self.hands.that_moved(name)
        command = Update(
            id=_new_id(),
            source="scene",
            agent=hand.agent,
            name=name,
            at=pose.position_m,
            orientation=pose.orientation_wxyz,
            reason=hand.reason,
        )
        hold(self._commit_once(structs.replace(transactions.place(command), verb=hand.verb)), self._ask)

    def _changing(self, command: Add | Update) -> Talk[Changed]:
        return self._add(command) if isinstance(command, Add) else self._update(command)

    @once
    def _add(self, command: Add) -> Talk[Changed]:
        found = self.classes.spatial(command.class_)
        name = command.name or free_name(found.name, self.entities)
        if name in self.entities:
            raise errors.NameTaken(f"the name '{name}' is taken; see: semmap get {name}")
        at = command.at or free_position(self.entities.values(), command.size)
        pose = pose_of(at, command.yaw, command.orientation)
        ref = command.ref or (_label(found) if command.default else None)

        def build(suffix: str) -> Talk[Transaction]:
            return transactions.add(command, name, found, pose, ref, suffix)
            yield  # nothing to ask

        commit = yield from self._commit(build)
        return Changed(
            commit=_seq(commit),
            text=f"added {found.name} {name} at {_metres(pose)}",
            names=(name,),
            notes=self.classes.note(command.class_, found),
        )

    @once
    def _update(self, command: Update) -> Talk[Changed]:
        entity = self.entity(command.name)
        found = self.classes.spatial(command.class_) if command.class_ is not None else None
        changes = (found, command.ref, command.alt, command.size)
        if any(change is not None for change in changes):
            require_authority(command, [entity])

        def build(suffix: str) -> Talk[Transaction]:
            (star,) = yield from _stars((entity.name,))
            return transactions.update(command, self.entity(entity.name), star, found, suffix)

        if all(change is None for change in (*changes, command.conflict)):
            commit = yield from self._commit_once(transactions.place(command))
        else:
            commit = yield from self._commit(build)
        return Changed(
            commit=_seq(commit),
            text=f"updated {entity.name}" if commit else f"{entity.name} is like that already",
            names=(entity.name,),
            notes=self.classes.note(command.class_ or "", found) if found else (),
        )

    @once
    def _remove(self, command: Remove) -> Talk[Changed]:
        if not command.names:
            raise errors.BadRequest("name at least one entity to remove")
        leaving = [self.entity(name) for name in dict.fromkeys(command.names)]
        require_authority(command, leaving)
        return (yield from self._take_out(command, f"remove {' '.join(e.name for e in leaving)}", leaving))

    @once
    def _clear(self, command: Clear) -> Talk[Changed]:
        require_authority(command, self.entities.values())
        return (yield from self._take_out(command, "clear", list(self.entities.values())))

    @once
    def _load(self, command: Load) -> Talk[Changed]:
        if command.source == "operator":
            command = structs.replace(command, source="file")
        if command.tbox:
            return (yield from self._load_tbox(command))
        if command.replace:
            require_authority(command, self.entities.values())
        kind = kind_of(command.content, command.filename)
        if kind == "abox":
            return (yield from self._load_document(command))
        described = READERS[kind](command.content, command.filename)
        known, skipped, notes = self._sort_out(described, skip_unknown=command.skip_unknown)
        taken = set() if command.replace else set(self.entities)
        insert: dict[Triple, None] = {}
        names: list[str] = []
        for item, found in known:
            name = item.name or free_name(found.name, taken)
            if name in taken:
                raise errors.NameTaken(
                    f"the name '{name}' is taken already; --replace takes the present map out"
                )
            taken.add(name)
            names.append(name)
            insert.update(dict.fromkeys(transactions.describe(name, found, item)))
        gone = (yield from _stars(tuple(self.entities))) if command.replace and self.entities else ()

        def build(_: str) -> Talk[Transaction]:
            return transactions.transaction(
                command,
                f"load {command.filename}",
                retract=[t for star in gone for t in (*star.own, *star.incoming)],
                insert=insert,
            )
            yield  # nothing to ask

        commit = yield from self._commit(build)
        return _loaded(command, commit, tuple(names), skipped, notes)

    @once
    def _undo(self, command: Undo) -> Talk[Changed]:
        commit: Commit = yield Question("undo", command)
        self._taken(commit)
        first, *settling = commit.undoes
        text = f"took back commit {first}" + (
            f" with the {len(settling)} that settled it" if settling else ""
        )
        return Changed(commit=commit.seq, text=text, names=commit.names)

    def done_before(self, command: Command) -> Talk[Changed | None]:
        """The result of the command with this id, if there was one."""
        nothing = Transaction(id=command.id, source=command.source)
        commit: Commit | None = yield Question("commit", nothing)
        if commit is None:
            return None
        names = tuple(entity.name for entity in commit.changed) or tuple(gone.name for gone in commit.removed)
        return Changed(commit=commit.seq, text=f"done before: {commit.reason}", names=names)

    def _load_document(self, command: Load) -> Talk[Changed]:
        document = LoadDocument(
            id=command.id,
            source=command.source,
            agent=command.agent,
            reason=command.reason or f"load {command.filename}",
            content=command.content,
            filename=command.filename,
            replace=command.replace,
            skip_unknown=command.skip_unknown,
        )
        loaded: Loaded = yield Question("load", document)
        names = tuple(e.name for e in loaded.commit.changed) if loaded.commit else ()
        return _loaded(command, self._taken(loaded.commit), names, loaded.skipped, loaded.notes)

    def _load_tbox(self, command: Load) -> Talk[Changed]:
        if command.replace or command.skip_unknown:
            raise errors.BadRequest("a TBox takes the place of the present one, and the map stays as it is")
        require_operator(command, "replace the TBox")
        order = LoadTBox(
            id=command.id,
            source=command.source,
            agent=command.agent,
            reason=command.reason or f"load the TBox {command.filename}",
            content=command.content,
            filename=command.filename,
        )
        commit: Commit = yield Question("load-tbox", order)
        self._taken(commit)
        self.classes = ClassNames((yield Question("classes", Classes())))
        text = f"{len(self.classes.by_name)} classes from {command.filename or 'the file'}"
        return Changed(commit=commit.seq, text=text, names=commit.names)

    def _sort_out(
        self, described: Iterable[Described], *, skip_unknown: bool
    ) -> tuple[list[tuple[Described, ClassInfo]], tuple[str, ...], tuple[str, ...]]:
        """Those of a known class, a word on each of the others, and how class names were read."""
        known: list[tuple[Described, ClassInfo]] = []
        unknown: dict[str, list[str]] = {}
        notes: dict[str, None] = {}
        for i, item in enumerate(described, start=1):
            try:
                found = self.classes.spatial(item.class_)
            except errors.UnknownClass:
                unknown.setdefault(item.class_, []).append(item.name or f"entity {i}")
                continue
            known.append((item, found))
            notes.update(dict.fromkeys(self.classes.note(item.class_, found)))
        if unknown and not skip_unknown:
            raise errors.UnknownClass(errors.unknown_classes(unknown, self.classes.by_name))
        skipped = tuple(f"{name} (unknown class '{c}')" for c, names in unknown.items() for name in names)
        return known, skipped, tuple(notes)

    def _take_out(self, command: Command, reason: str, leaving: list[Entity]) -> Talk[Changed]:
        names = tuple(entity.name for entity in leaving)
        if not names:
            return Changed(commit=None, text="the map is empty already")

        def build(_: str) -> Talk[Transaction]:
            return transactions.remove(command, reason, (yield from _stars(names)))

        commit = yield from self._commit(build)
        return Changed(commit=_seq(commit), text=f"removed {len(names)}: {_few(names)}", names=names)

    def _commit(self, build: Callable[[str], Talk[Transaction]]) -> Talk[Commit | None]:
        """Commit what `build(suffix)` gives; again if somebody was quicker, or has a name it needs."""
        suffix = ""
        for attempt in range(_ATTEMPTS):
            transaction = yield from build(suffix)
            try:
                return (yield from self._commit_once(transaction))
            except errors.PreconditionFailed:
                if attempt == _ATTEMPTS - 1:
                    raise
            except errors.NameTaken:
                if suffix:
                    raise
                suffix = f"_{self.seq + 1}"
        raise AssertionError("the last attempt returns or raises")

    def _commit_once(self, transaction: Transaction) -> Talk[Commit | None]:
        return self._taken((yield Question("commit", transaction)))

    def _taken(self, commit: Commit | None) -> Commit | None:
        if commit is not None:
            self.take(commit)
        return commit


def _stars(names: tuple[str, ...]) -> Talk[tuple[Star, ...]]:
    stars: tuple[Star, ...] = yield Question("star", StarQuery(names=names))
    return stars


def _independent(commands: Iterable[Add | Update]) -> Iterator[list[Add | Update]]:
    """The commands in runs of which no one depends on another: each of an entity of its own.

    An entity without a name or a place gets one that suits the others, so it goes alone.
    """
    run: list[Add | Update] = []
    names: set[str] = set()
    for command in commands:
        alone = isinstance(command, Add) and (command.name is None or command.at is None)
        if run and (alone or command.name in names):
            yield run
            run, names = [], set()
        run.append(command)
        names.add(command.name or "")
        if alone:
            yield run
            run, names = [], set()
    if run:
        yield run


def _new_id() -> str:
    return uuid.uuid4().hex


def _label(found: ClassInfo) -> str:
    return found.labels.get("en") or found.labels.get("") or found.name.replace("_", " ").lower()


def _metres(pose: Pose) -> str:
    return "({:g}, {:g}, {:g})".format(*pose.position_m)


def _few(names: tuple[str, ...]) -> str:
    return ", ".join(names) if len(names) <= 10 else f"{', '.join(names[:9])} and {len(names) - 9} more"


def _loaded(
    command: Load,
    commit: Commit | None,
    names: tuple[str, ...],
    skipped: tuple[str, ...],
    notes: tuple[str, ...],
) -> Changed:
    text = f"loaded {len(names)} entities from {command.filename or 'the file'}"
    if commit is None:
        text = f"{command.filename or 'the file'} says nothing that the map does not hold already"
    if skipped:
        text += f", left out {len(skipped)}"
    return Changed(commit=_seq(commit), text=text, names=names, skipped=skipped, notes=notes)


def _seq(commit: Commit | None) -> int | None:
    return None if commit is None else commit.seq
