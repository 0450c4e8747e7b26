"""What the journal tells of the past. Reads only, so it may run beside the node's own work.

Each commit holds the entities that it changed as they were after it. So the map at commit n is, for each
name, what the last commit up to n that touched it says: nothing needs to be replayed or inferred again.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from datetime import datetime

from nodes.kb_node.documents import rdf
from nodes.kb_node.documents.tbox import tbox_validation
from nodes.kb_node.entities import entity_reading
from nodes.kb_node.entities.class_table import ClassTable
from nodes.kb_node.reasoner import Reasoner
from nodes.kb_node.storage.changelog import Changelog
from nodes.kb_node.storage.journal import Journal
from schemas import errors
from schemas.changes import Change
from schemas.commands import History
from schemas.commits import Commit
from schemas.entities import Entity, Provenance
from schemas.moments import When, read_moment
from schemas.replies import LoggedCommit, Sighting


class Past:
    """The past of the map in a journal."""

    def __init__(self, journal: Journal) -> None:
        self._journal = journal
        self._first: dict[str, Entity] | None = None

    def history(self, query: History) -> tuple[LoggedCommit, ...]:
        """The commits of a span of time, newest last. Raises UnknownName, BadRequest."""
        first = 1 if query.since is None else self._not_before(query.since)
        last = self._journal.last if query.until is None else self._not_after(query.until)
        if query.name is None:
            seqs = list(range(max(first, last - query.limit + 1), last + 1))
        else:
            self._require_known(query.name)
            seqs = self._journal.touching(query.name, after=first - 1, until=last)[-query.limit :]
        changes = Changelog(self._journal, self.said_by_the_first_tbox)
        commits = map(self._journal.commit, seqs)
        return tuple(_logged(commit, changes.of(commit, query.name)) for commit in commits)

    def commits(self, seqs: Iterable[int]) -> tuple[Commit, ...]:
        """These commits, whole; without those that there never were."""
        last = self._journal.last
        return tuple(self._journal.commit(seq) for seq in seqs if 1 <= seq <= last)

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
        there = dict(self.said_by_the_first_tbox())
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
            entity = self.said_by_the_first_tbox().get(name)
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
        return sighting(self.said_by_the_first_tbox()[name], removed)

    def _require_known(self, name: str) -> None:
        if name not in self.said_by_the_first_tbox() and not self._journal.touching(name):
            known = [there for there, _ in self._journal.last_touches(self._journal.last)]
            raise errors.UnknownName(f"no entity was ever named '{name}'{errors.did_you_mean(name, known)}")

    def said_by_the_first_tbox(self) -> Mapping[str, Entity]:
        """The entities of the map before the first commit."""
        if self._first is None:
            tbox = rdf.parse(self._journal.tbox(0), "the first TBox")
            self._first = {}
            if tbox_validation.has_individuals(tbox):
                reasoner = Reasoner(tbox)
                said = entity_reading.of_the_tbox(reasoner, ClassTable(reasoner))
                self._first.update((entity.name, entity) for entity in said)
        return self._first

    def commit_at(self, when: When) -> int:
        """The commit after which the map was as then. Raises Refused for the future and before it all."""
        moment, last = read_moment(when), self._journal.last
        if moment.first_ns > time.time_ns():
            raise errors.Refused("that is in the future; ask about the present without --as-of")
        seq = self._journal.seq_at(moment.last_ns) if moment.commit is None else moment.commit
        if seq > last:
            raise errors.Refused(f"there is no commit {seq} yet; the last one is {last}")
        if seq == 0:
            raise errors.Refused(f"there was no map then; it begins with commit 1{self._begun()}")
        return seq

    def _begun(self) -> str:
        if self._journal.last == 0:
            return ""
        begun = datetime.fromtimestamp(self._journal.stamp_of(1) / 1e9)
        return f" at {begun:%Y-%m-%d %H:%M:%S}"

    def _not_before(self, when: When) -> int:
        moment = read_moment(when)
        if moment.commit is None:
            return self._journal.seq_at(moment.first_ns - 1) + 1
        return max(moment.commit, 1)

    def _not_after(self, when: When) -> int:
        moment = read_moment(when)
        if moment.commit is None:
            return self._journal.seq_at(moment.last_ns)
        return min(moment.commit, self._journal.last)


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
