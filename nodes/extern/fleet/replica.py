"""The state of the copy of one robot: the metadata of its graph, and the commits that are to be written next.

The metadata in the server is authoritative: a commit is written when the server reports it as the commit of
the graph.
"""

from __future__ import annotations

from typing import Final, Literal

from msgspec import structs

from semmap.nodes.extern.fleet import facts as f
from semmap.nodes.extern.fleet.facts import Facts
from semmap.nodes.extern.fleet.synchronization import FullCopy, NextCommits
from semmap.nodes.extern.fleet.updates import Change
from semmap.schemas import errors
from semmap.schemas.commits import Commit

MOST_AHEAD: Final = 5000
"""The maximum number of commits that wait for being written; later ones are fetched again."""
MOST_TRIPLES: Final = 20_000
"""The maximum number of triples in one operation, unless a single commit has more."""

Phase = Literal["behind", "in_sync"]


class Replica:
    """The copy of one robot's map, without Zenoh and the server. It is owned by one thread."""

    def __init__(self, robot: str) -> None:
        self.robot = robot
        self.phase: Phase = "behind"
        """`behind`: the copy must be synchronized before further commits are written."""
        self.generation = 0
        """Incremented with every new process of the knowledge base; earlier requests are void then."""
        self.facts: Facts | None = None
        self.copying: FullCopy | None = None
        """The map that must be copied."""
        self._next: dict[int, Commit] = {}
        self._most_triples = MOST_TRIPLES

    @property
    def has_work(self) -> bool:
        """Whether there is something to write."""
        return self.copying is not None or (self.phase == "in_sync" and self._first in self._next)

    @property
    def waiting(self) -> int:
        """The number of commits that are not written yet."""
        return len(self._next)

    @property
    def _first(self) -> int:
        return -1 if self.facts is None or self.facts.commit is None else self.facts.commit + 1

    def restart(self) -> None:
        """Start again: the knowledge base is a new process and may have another map."""
        self.generation += 1
        self.phase, self.copying = "behind", None
        self._next.clear()

    def add_commit(self, commit: Commit) -> None:
        """Add a published commit. If it does not follow the previous one, the copy is behind."""
        if self.facts is not None and commit.seq == self.facts.commit and commit.digest != self.facts.digest:
            self.phase = "behind"
        if commit.seq < self._first:
            return
        if commit.abridged is not None or commit.tbox or len(self._next) >= MOST_AHEAD:
            self.phase = "behind"
            return
        self._next[commit.seq] = commit
        if self.phase == "in_sync" and self._first not in self._next:
            self.phase = "behind"  # a commit was missed

    def synchronize(self, found: NextCommits | FullCopy | None, generation: int) -> None:
        """Apply the result of a synchronization, unless it belongs to an earlier generation."""
        if generation != self.generation or found is None:
            return
        if isinstance(found, FullCopy):
            self.copying = found
            return
        if found.commits and found.commits[0].seq > self._first:
            return  # the server was reset in the meantime: synchronize again
        self._next.update((commit.seq, commit) for commit in found.commits if commit.seq >= self._first)
        self.phase = "in_sync"

    def change(self) -> tuple[Change, Facts] | None:
        """Return the next commits as one change, with the metadata after it."""
        facts = self.facts
        if self.phase != "in_sync" or facts is None or facts.commit is None or self._first not in self._next:
            return None
        change = Change(self.robot, facts.frame)
        commit = None
        seq = self._first
        while seq in self._next and len(change) < self._most_triples:
            commit = self._next[seq]
            change.take(commit)
            seq += 1
        if commit is None:
            raise errors.InternalError("there is no commit to write")
        return change, structs.replace(
            facts, commit=commit.seq, digest=commit.digest, stamp=f.iso(commit.stamp_ns)
        )

    def halve_changes(self, refused: int, wanted: Facts) -> bool:
        """Halve the size of changes after the server rejected one of `refused` triples, up to `wanted`.

        Returns False if the change was a single commit, which cannot be divided.
        """
        if self.copying is not None or wanted.commit is None or wanted.commit <= self._first:
            return False
        self._most_triples = max(1, min(refused, self._most_triples) // 2)
        return True

    def update_facts(self, facts: Facts | None, wanted: Facts | None = None) -> None:
        """Set the metadata in the server. If it is not `wanted`, the copy is behind."""
        self.facts = facts
        if wanted is not None and facts is not None and facts.digest == wanted.digest and not facts.copying:
            if self.copying is not None:
                self.copying, self.phase = None, "in_sync"
        elif wanted is not None:
            self.phase, self.copying = "behind", None
        for seq in [seq for seq in self._next if seq < self._first]:
            del self._next[seq]
        if self.phase == "in_sync" and self._next and self._first not in self._next:
            self.phase = "behind"
