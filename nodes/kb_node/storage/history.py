"""The history of a map, read from its journal. It never writes, so it may run beside other work.

Each commit holds the entities that it changed, as they were after it. Thus the state of an entity at commit
n is in the last commit up to n that touched it. Nothing needs to be replayed or inferred again.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence, Set
from datetime import datetime
from functools import cache

from msgspec import structs

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.documents.tbox import tbox_validation
from semmap.nodes.kb_node.entities import entity_reading
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.relations.selection import find_single
from semmap.nodes.kb_node.storage import closure_cache
from semmap.nodes.kb_node.storage.changelog import Changelog
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.ontology.entity_triples import find_earlier_names
from semmap.schemas import errors, wording
from semmap.schemas.changes import Change
from semmap.schemas.commands import History
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Entity, Provenance
from semmap.schemas.moments import Moment, When, read_moment
from semmap.schemas.replies import LoggedCommit, Sighting


class HistoryReader:
    """The history of the map in a journal."""

    def __init__(self, journal: Journal) -> None:
        self._journal = journal
        self._first: tuple[int, dict[str, Entity]] | None = None
        self._names: tuple[tuple[int, int], dict[str, list[tuple[int, str]]]] = (0, 0), {}

    def history(self, query: History, only: Set[int] | None = None) -> tuple[LoggedCommit, ...]:
        """Return the commits of a time span, newest last. Raises UnknownName, BadRequest.

        `only` are the commits that may be returned; None stands for all of them.

        Times are compared with the stamps of commits, between which the clock may have been set back. After
        compaction, the start of the history is returned as a commit, too. The commits of a renamed entity
        include those under its earlier names.
        """
        if query.name is not None:
            self.require_known(query.name)
        beginning = self._journal.beginning.seq
        if only is None:
            shown = self._list_shown(query)
        else:
            every = self._list_shown(structs.replace(query, limit=max(self._journal.last, 1)))
            shown = [each for each in every if each[0] in only][-query.limit :]
        changes = Changelog(self._journal, self.initial_entities)
        return tuple(
            _describe_beginning(self._journal)
            if seq == beginning
            else _to_logged_commit(commit := self._journal.commit(seq), changes.of(commit, name))
            for seq, name in shown
        )

    def _list_shown(self, query: History) -> list[tuple[int, str | None]]:
        """Return the newest of the requested commits in order, with the name of the entity at each."""
        beginning, before = self._journal.beginning.seq, self._journal.last + 1
        newest_first: list[tuple[int, str | None]] = []
        name, is_renamed = query.name, True
        while is_renamed:
            is_renamed = False
            seqs = [seq for seq in self._list_span(structs.replace(query, name=name)) if seq < before]
            for seq in reversed(seqs[-query.limit :]):
                if seq > beginning or name is None or name in self.initial_entities():
                    newest_first.append((seq, name))
                if name is not None and (earlier := self._find_earlier_name(seq, name)) is not None:
                    name, before, is_renamed = earlier, seq, len(newest_first) < query.limit
                    break
        return newest_first[: query.limit][::-1]

    def _find_earlier_name(self, seq: int, name: str) -> str | None:
        """Return the name that an entity had before a commit that renamed it, or None."""
        if seq <= self._journal.beginning.seq:
            return None
        return find_earlier_names(self._journal.commit(seq)).get(name)

    def list_names(self, name: str) -> list[tuple[int, str]]:
        """Return the names of an entity, newest first, each with the commit that gave it, 0 for the first.

        They are cached until the next commit or compaction.
        """
        stored = self._compacted, self._journal.last
        cached = self._names
        if cached[0] != stored:
            self._names = cached = stored, {}
        known = cached[1]
        if name not in known:
            known[name] = self._find_names(name, stored[1])
        return known[name]

    def _find_names(self, name: str, last: int) -> list[tuple[int, str]]:
        found: list[tuple[int, str]] = []
        before = last + 1
        while True:
            for seq in reversed(self._journal.touching(name, until=before - 1)):
                if (earlier := self._find_earlier_name(seq, name)) is not None:
                    found.append((seq, name))
                    name, before = earlier, seq
                    break
            else:
                return [*found, (0, name)]

    def find_later_names(self, names: Iterable[str], until: int) -> dict[str, str]:
        """Return the names after commit `until` of entities that were renamed, by their earlier names.

        `names` are names that no entity has after that commit.
        """
        last = dict(self._journal.last_touches(until))
        renamed: dict[int, dict[str, str]] = {}
        found: dict[str, str] = {}
        for name in names:
            later: str | None = name
            while later is not None and (seq := last.get(later)) is not None:
                if seq not in renamed:
                    earlier = find_earlier_names(self._journal.commit(seq))
                    renamed[seq] = {was: now for now, was in earlier.items()}
                if (later := renamed[seq].get(later)) is not None:
                    found[name] = later
        return found

    def match_names(self, then: Set[str], now: Set[str], first: int, last: int) -> dict[str, str]:
        """Return the names by `last` of entities that were renamed since commit `first`, by earlier ones.

        `then` and `now` are the names of all entities after these commits. An entity whose name was given
        to another one is found, too. Not found are two that exchanged their names, and one that has the
        name of a removed one.
        """
        matched = self.find_later_names(then - now, last)
        commit = cache(self._journal.commit)
        pending = dict.fromkeys(sorted(now - then - set(matched.values())), first)
        while pending:
            present, since = pending.popitem()
            name, until = present, last
            while seqs := self._journal.touching(name, after=since, until=until):
                if (earlier := find_earlier_names(commit(seqs[0])).get(name)) is None:
                    break  # it was added, or changed only
                name, since, until = earlier, first, seqs[0] - 1
                if name in then:
                    if name in now and name not in matched:  # another entity has that name now
                        pending[name] = seqs[0]
                    matched[name] = present
                    break
        return {was: name for was, name in matched.items() if name not in then or name in matched}

    def _list_span(self, query: History) -> Sequence[int]:
        """Return the numbers of the requested commits, in order."""
        since, until = (None if when is None else read_moment(when) for when in (query.since, query.until))
        first = since.commit if since is not None and since.commit is not None else 0
        last = until.commit if until is not None and until.commit is not None else self._journal.last
        seqs: Sequence[int] = range(max(first, self._journal.first - 1, 1), min(last, self._journal.last) + 1)
        if query.name is not None:
            touching = self._journal.touching(query.name, after=max(first - 1, 0), until=last)
            seqs = [*seqs[: self._journal.beginning.seq in seqs], *touching]
        first_ns = since.first_ns if since is not None and since.commit is None else 0
        last_ns = until.last_ns if until is not None and until.commit is None else 0
        if first_ns or last_ns:
            stamped = set(self._journal.stamps.within(first_ns, last_ns or 1 << 63))
            seqs = [seq for seq in seqs if seq in stamped]
        return seqs

    def commits(self, seqs: Iterable[int]) -> tuple[Commit, ...]:
        """Return these commits, without those that do not exist."""
        last = self._journal.last
        return tuple(self._journal.commit(seq) for seq in seqs if self._journal.first <= seq <= last)

    def entities(
        self, when: When, class_name: str | None = None, known: Iterable[str] = ()
    ) -> tuple[Entity, ...]:
        """Return the map at a time, or the entities of a class by their types at that time.

        `known` are the current classes. Raises Refused if there was no map, UnknownClass, BadRequest.
        """
        there = self._list_entities(self.commit_at(when))
        if class_name is None:
            return there
        classes = {t for entity in there for t in entity.types}.union(known)
        if class_name not in classes:
            raise errors.UnknownClass(
                f"unknown class '{class_name}'{errors.suggestion(class_name, classes, 'classes')}"
            )
        return tuple(entity for entity in there if class_name in entity.types)

    def _list_entities(self, seq: int) -> tuple[Entity, ...]:
        """Return the entities after a commit, ordered by name."""
        there = dict(self.initial_entities())
        names_by_seq: dict[int, list[str]] = {}
        for name, touched in self._journal.last_touches(seq):
            names_by_seq.setdefault(touched, []).append(name)
        for touched, names in names_by_seq.items():
            after = _entities_after(self._journal.commit(touched))
            for name in names:
                there.pop(name, None)
            there.update((name, after[name]) for name in names if name in after)
        return tuple(there[name] for name in sorted(there))

    def entity(self, name: str, when: When) -> Entity:
        """Return an entity at a time. Raises UnknownName, Refused if there was no map, BadRequest."""
        seq = self.commit_at(when)
        touching = self._journal.touching(name, until=seq)
        if touching:
            entity = _entities_after(self._journal.commit(touching[-1])).get(name)
        else:
            entity = self.initial_entities().get(name)
        if entity is None:
            known = [there for there, _ in self._journal.last_touches(seq)]
            hint = errors.did_you_mean(name, known) if name not in known else ""
            raise errors.UnknownName(f"no entity was named '{name}' after commit {seq}{hint}")
        return entity

    def last_seen(self, name: str) -> Sighting:
        """Return the last pose of an entity and its provenance.

        Raises UnknownName, also for the earlier name of a renamed entity.
        """
        self.require_known(name)
        removed: Provenance | None = None
        for seq in reversed(self._journal.touching(name)):
            commit = self._journal.commit(seq)
            entity = _entities_after(commit).get(name)
            if entity is not None:
                return make_sighting(entity, removed)
            later = {was: now for now, was in find_earlier_names(commit).items()}.get(name)
            if removed is None and later is not None:
                raise errors.UnknownName(
                    f"{name} was renamed to {later} in commit {seq}; see: semmap last-seen {later}"
                )
            removed = commit.provenance
        return make_sighting(self.initial_entities()[name], removed)

    def in_conflict_since(self, entity: Entity) -> Provenance:
        """Return the commit that stated the current conflict of an entity."""
        stated = entity.pose_provenance
        for seq in reversed(self._journal.touching(entity.name)):
            commit = self._journal.commit(seq)
            then = _entities_after(commit).get(entity.name)
            if then is None or then.conflict != entity.conflict:
                break
            stated = commit.provenance
        return stated

    @property
    def last(self) -> int:
        """Return the number of the last commit, 0 before the first."""
        return self._journal.last

    def knows(self, name: str) -> bool:
        """Return whether an entity ever had this name, within the stored history."""
        return bool(self._journal.touching(name)) or name in self.initial_entities()

    def resolve(self, word: str, present: Sequence[Entity]) -> str:
        """Return the present or former name that a word is, else the one entity in `present` that it means.

        Raises UnknownName; BadRequest for a label or class that several have.
        """
        if not self.knows(word) and (name := find_single(present, word)) is not None:
            return name
        self.require_known(word)
        return word

    def resolve_renamed(self, word: str, present: Sequence[Entity]) -> str:
        """Return the same, but the present name for the earlier name of a renamed entity."""
        name = self.resolve(word, present)
        if any(entity.name == name for entity in present):
            return name
        return self.find_later_names([name], self._journal.last).get(name, name)

    def touching(self, name: str) -> list[tuple[int, str]]:
        """Return the commits that touched an entity, in order, each with the name that it had then."""
        found: list[tuple[int, str]] = []
        until = self._journal.last
        for since, had in self.list_names(name):
            seqs = self._journal.touching(had, after=max(since - 1, 0), until=until)
            found += [(seq, had) for seq in reversed(seqs)]
            until = since - 1
        return found[::-1]

    def require_known(self, name: str) -> None:
        """Raise UnknownName for a name that no entity ever had."""
        if not self.knows(name):
            known = [there for there, _ in self._journal.last_touches(self._journal.last)]
            since = f" since commit {seq}, which the history begins with" if (seq := self._compacted) else ""
            raise errors.UnknownName(
                f"no entity was ever named '{name}'{since}{errors.suggestion(name, known, 'list')}"
            )

    @property
    def _compacted(self) -> int:
        """Return the last commit that is part of the snapshot, or 0."""
        return self._journal.beginning.seq

    def initial_entities(self) -> Mapping[str, Entity]:
        """Return the entities of the snapshot that starts the history, else those of the first TBox."""
        if self._first is None or self._first[0] != self._compacted:
            entities = (
                self._journal.snapshot().entities if self._compacted else self._read_first_tbox_entities()
            )
            self._first = (self._compacted, {entity.name: entity for entity in entities})
        return self._first[1]

    def _read_first_tbox_entities(self) -> Iterable[Entity]:
        tbox = rdf.parse(self._journal.tbox(0), "the first TBox")
        if not tbox_validation.has_individuals(tbox):
            return ()
        reasoner = closure_cache.load_reasoner(tbox, self._journal.path.parent, of_the_past=True)
        return entity_reading.read_tbox_entities(reasoner, ClassTable(reasoner))

    def moment(self, when: When) -> Moment:
        """Return a commit or time as an interval of time. Raises BadRequest, Refused for unknown commits."""
        moment = read_moment(when)
        if moment.commit is None:
            return moment
        seq = self.commit_at(when)
        stamp_ns = self._journal.stamps.of(seq) if seq > self._compacted else self._journal.beginning.stamp_ns
        return Moment(first_ns=stamp_ns, last_ns=stamp_ns)

    def commit_at(self, when: When) -> int:
        """Return the last commit at a time. Raises Refused for the future and before the history."""
        moment, last = read_moment(when), self._journal.last
        if moment.first_ns > max(time.time_ns(), self._journal.stamps.latest() if moment.first_ns else 0):
            raise errors.Refused(f"the time is in the future; the last commit is {last}")
        seq = self._journal.stamps.seq_at(moment.last_ns) if moment.commit is None else moment.commit
        if seq > last:
            raise errors.Refused(f"there is no commit {seq} yet; the last one is {last}")
        if seq < self._compacted:
            raise errors.Refused(
                f"commits before {self._compacted}{_at(self._journal.beginning.stamp_ns)} have been"
                " compacted: the history begins with the map at that commit"
            )
        if seq == 0:
            begun = "" if last == 0 else _at(self._journal.stamps.of(1))
            raise errors.Refused(f"there was no map at that time; it begins with commit 1{begun}")
        return seq

    def commit_before(self, when: When) -> int:
        """Return the last commit at the beginning of a minute or day, or the first if the map began in it.

        For a commit's number or an exact time it is the same as `commit_at`, which raises the same errors.
        """
        at_end, moment = self.commit_at(when), read_moment(when)
        if moment.commit is not None or moment.is_exact:
            return at_end
        return max(self._journal.stamps.seq_at(moment.first_ns), self._compacted, 1)


def _at(stamp_ns: int) -> str:
    return f" at {datetime.fromtimestamp(stamp_ns / 1e9):%Y-%m-%d %H:%M:%S}"


def _describe_beginning(journal: Journal) -> LoggedCommit:
    """Return the start of a compacted history, represented as a commit."""
    there = journal.beginning
    return LoggedCommit(
        seq=there.seq,
        stamp_ns=there.stamp_ns,
        source="file",
        agent="",
        verb="compact",
        reason=(
            f"the history begins here, with {wording.entities(there.entities)};"
            " earlier commits were compacted"
        ),
        confidence=None,
        undoes=(),
        tbox=False,
        inserted=0,
        retracted=0,
        changed=(),
        removed=(),
    )


def _entities_after(commit: Commit) -> dict[str, Entity]:
    """Return the entities that the commit changed and did not remove, by name."""
    return {entity.name: entity for entity in commit.changed}


def make_sighting(entity: Entity, removed: Provenance | None) -> Sighting:
    """Return the last pose of an entity, and what removed it."""
    return Sighting(name=entity.name, pose=entity.pose, provenance=entity.pose_provenance, removed=removed)


def _to_logged_commit(commit: Commit, changes: tuple[Change, ...]) -> LoggedCommit:
    return LoggedCommit(
        seq=commit.seq,
        stamp_ns=commit.stamp_ns,
        source=commit.source,
        agent=commit.agent,
        authenticated=commit.authenticated,
        verb=commit.verb,
        reason=commit.reason,
        confidence=commit.confidence,
        undoes=commit.undoes,
        tbox=commit.tbox,
        inserted=len(commit.inserted),
        retracted=len(commit.retracted),
        changed=tuple(entity.name for entity in commit.changed),
        removed=tuple(gone.name for gone in commit.removed),
        changes=changes,
        notes=commit.notes,
    )
