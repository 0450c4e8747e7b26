"""What a node knows of the map by following it: the last snapshot, kept fresh by the commits since."""

from __future__ import annotations

from schemas.commits import Commit, Snapshot
from schemas.entities import Entity


class MapReplica:
    """The entities by name, as of commit `seq`; -1 before a first snapshot."""

    def __init__(self) -> None:
        self.seq = -1
        self.entities: dict[str, Entity] = {}
        self._heard = -1

    @property
    def is_behind(self) -> bool:
        """Was a commit heard of that it lacks? One may come before a snapshot that was made without it."""
        return self.seq < self._heard

    def begin(self, snapshot: Snapshot) -> None:
        """Take over a snapshot."""
        self.seq = snapshot.seq
        self.entities = {entity.name: entity for entity in snapshot.entities}

    def take(self, commit: Commit) -> bool:
        """Take over a commit. False when one before it was missed, so that a snapshot is needed."""
        self._heard = max(self._heard, commit.seq)
        if commit.seq == self.seq + 1:
            self.seq = commit.seq
            for gone in commit.removed:
                self.entities.pop(gone.name, None)
            self.entities.update({entity.name: entity for entity in commit.changed})
        return commit.seq <= self.seq

    def doubt(self) -> None:
        """Another knowledge base may know less than what was heard of the one before."""
        self._heard = -1
