"""What perception knows of the map: the last snapshot, kept fresh by the commits."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from nodes.perception_node.kinship import Kinship
from schemas.commits import Commit, Snapshot
from schemas.entities import ClassInfo, Entity, Size


class MapView:
    """The entities by name, as of commit `seq`; -1 before a first snapshot."""

    def __init__(self) -> None:
        self.seq = -1
        self.entities: dict[str, Entity] = {}

    def begin(self, snapshot: Snapshot) -> None:
        """Take over a snapshot."""
        self.seq = snapshot.seq
        self.entities = {entity.name: entity for entity in snapshot.entities}

    def take(self, commit: Commit) -> bool:
        """Take over a commit. False when one before it was missed, so that a snapshot is needed."""
        if commit.seq <= self.seq:
            return True
        if commit.seq != self.seq + 1:
            return False
        self.seq = commit.seq
        for gone in commit.removed:
            self.entities.pop(gone.name, None)
        self.entities.update({entity.name: entity for entity in commit.changed})
        return True


def kinship_of(classes: Iterable[ClassInfo], usual_m: Mapping[str, Size]) -> Kinship:
    """The hierarchy and the labels of the TBox's classes, with what is known of their sizes."""
    rows = list(classes)
    labels = {row.name: row.labels.get("en") or row.labels.get("") or "" for row in rows}
    return Kinship({row.name: frozenset(row.ancestors) for row in rows}, labels, usual_m)
