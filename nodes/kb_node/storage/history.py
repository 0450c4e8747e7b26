"""What the journal tells of the past. Reads only, so it may run beside the node's own work.

Each commit holds the entities that it changed as they were after it. So the map at commit n is, for each
name, what the last commit up to n that touched it says: nothing needs to be replayed or inferred again.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from datetime import datetime

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.documents.tbox import tbox_validation
from semmap.nodes.kb_node.entities import entity_reading
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.storage.changelog import Changelog
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.schemas import errors, wording
from semmap.schemas.changes import Change
from semmap.schemas.commands import History
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Entity, Provenance
from semmap.schemas.moments import When, read_moment
from semmap.schemas.replies import LoggedCommit, Sighting


class Past:
    """The past of the map in a journal."""

    def __init__(self, journal: Journal) -> None:
        self._journal = journal
        self._first: tuple[int, dict[str, Entity]] | None = None

    def history(self, query: History) -> tuple[LoggedCommit, ...]:
        """The commits of a span of time, newest last. Raises UnknownName, BadRequest.

        Times are compared with the commits' own stamps, which the clock may have been set back between. What
        the history begins with is told as a commit, too, if it was compacted.
        """
        if query.name is not None:
            self._require_known(query.name)
        seqs = self._of_span(query)
        beginning = self._journal.beginning.seq
        told = [seq for seq in seqs if seq > beginning]
        if beginning in seqs and (query.name is None or query.name in self.at_the_beginning()):
            told.insert(0, beginning)
        changes = Changelog(self._journal, self.at_the_beginning)
        return tuple(
            _beginning(self._journal)
            if seq == beginning
            else _logged(commit := self._journal.commit(seq), changes.of(commit, query.name))
            for seq in told[-query.limit :]
        )

    def _of_span(self, query: History) -> Sequence[int]:
        """The numbers of the commits that are asked for, in order."""
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
        """These commits, whole; without those that there never were."""
        last = self._journal.last
        return tuple(self._journal.commit(seq) for seq in seqs if self._journal.first <= seq <= last)

    def entities(
        self, when: When, class_name: str | None = None, known: Iterable[str] = ()
    ) -> tuple[Entity, ...]:
        """The map as it was, or those of a class by the types of then; `known` are the classes of today.

        Raises Refused when there was no map, UnknownClass, BadRequest.
        """
        there = self._there(self.commit_at(when))
        if class_name is None:
            return there
        classes = {t for entity in there for t in entity.types}.union(known)
        if class_name not in classes:
            raise errors.UnknownClass(
                f"unknown class '{class_name}'{errors.did_you_mean(class_name, classes)}"
            )
        return tuple(entity for entity in there if class_name in entity.types)

    def _there(self, seq: int) -> tuple[Entity, ...]:
        """The entities after a commit, in the order of names."""
        there = dict(self.at_the_beginning())
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
        """One entity as it was. Raises UnknownName, Refused when there was no map, BadRequest."""
        seq = self.commit_at(when)
        touching = self._journal.touching(name, until=seq)
        if touching:
            entity = _entities_after(self._journal.commit(touching[-1])).get(name)
        else:
            entity = self.at_the_beginning().get(name)
        if entity is None:
            known = [there for there, _ in self._journal.last_touches(seq)]
            hint = errors.did_you_mean(name, known) if name not in known else ""
            raise errors.UnknownName(f"no entity was named '{name}' after commit {seq}{hint}")
        return entity

    def last_seen(self, name: str) -> Sighting:
        """Where an entity was last, and by whose word. Raises UnknownName."""
        self._require_known(name)
        removed: Provenance | None = None
        for seq in reversed(self._journal.touching(name)):
            commit = self._journal.commit(seq)
            entity = _entities_after(commit).get(name)
            if entity is not None:
                return sighting(entity, removed)
            removed = commit.provenance
        return sighting(self.at_the_beginning()[name], removed)

    def in_conflict_since(self, entity: Entity) -> Provenance:
        """The commit by which the conflict that an entity has was stated."""
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
        """The number of the last commit, 0 before the first."""
        return self._journal.last

    def knows(self, name: str) -> bool:
        """Whether an entity was ever named so, as far as the history goes back."""
        return name in self.at_the_beginning() or bool(self._journal.touching(name))

    def _require_known(self, name: str) -> None:
        if not self.knows(name):
            known = [there for there, _ in self._journal.last_touches(self._journal.last)]
            since = f" since commit {seq}, which the history begins with" if (seq := self._compacted) else ""
            raise errors.UnknownName(
                f"no entity was ever named '{name}'{since}{errors.did_you_mean(name, known)}"
            )

    @property
    def _compacted(self) -> int:
        """The last commit that is part of the snapshot which the history begins with; 0 if there is none."""
        return self._journal.beginning.seq

    def at_the_beginning(self) -> Mapping[str, Entity]:
        """The entities of the snapshot that the history begins with, else those that the first TBox says."""
        if self._first is None or self._first[0] != self._compacted:
            said = self._journal.snapshot().entities if self._compacted else self._said_by_the_first_tbox()
            self._first = (self._compacted, {entity.name: entity for entity in said})
        return self._first[1]

    def _said_by_the_first_tbox(self) -> Iterable[Entity]:
        tbox = rdf.parse(self._journal.tbox(0), "the first TBox")
        if not tbox_validation.has_individuals(tbox):
            return ()
        reasoner = Reasoner(tbox)
        return entity_reading.read_tbox_entities(reasoner, ClassTable(reasoner))

    def commit_at(self, when: When) -> int:
        """The commit after which the map was as then. Raises Refused for the future and before it all."""
        moment, last = read_moment(when), self._journal.last
        if moment.first_ns > max(time.time_ns(), self._journal.stamps.latest() if moment.first_ns else 0):
            raise errors.Refused(f"that is in the future; the last commit so far is {last}")
        seq = self._journal.stamps.seq_at(moment.last_ns) if moment.commit is None else moment.commit
        if seq > last:
            raise errors.Refused(f"there is no commit {seq} yet; the last one is {last}")
        if seq < self._compacted:
            raise errors.Refused(
                f"what was before commit {self._compacted}{_at(self._journal.beginning.stamp_ns)} has been"
                " compacted: the history begins with the map as it was then"
            )
        if seq == 0:
            begun = "" if last == 0 else _at(self._journal.stamps.of(1))
            raise errors.Refused(f"there was no map then; it begins with commit 1{begun}")
        return seq


def _at(stamp_ns: int) -> str:
    return f" at {datetime.fromtimestamp(stamp_ns / 1e9):%Y-%m-%d %H:%M:%S}"


def _beginning(journal: Journal) -> LoggedCommit:
    """What the history of a compacted journal begins with, told as if it were a commit."""
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
    """Those that the commit changed and did not remove, by name."""
    return {entity.name: entity for entity in commit.changed}


def sighting(entity: Entity, removed: Provenance | None) -> Sighting:
    """Where an entity was, and what removed it."""
    return Sighting(name=entity.name, pose=entity.pose, provenance=entity.pose_provenance, removed=removed)


def _logged(commit: Commit, changes: tuple[Change, ...]) -> LoggedCommit:
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
