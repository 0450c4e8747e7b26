"""When entities were last seen, and which are missing: the command `last-seen`.

Commits record where an entity was last placed or observed. Nothing is committed while it stays there. The
time of the last observation therefore comes from the messages of perception, and is kept in memory only.
"""

from __future__ import annotations

import time
from typing import Final

from msgspec import structs

from semmap.nodes.kb_node.storage.history import HistoryReader, make_sighting
from semmap.schemas import wording
from semmap.schemas.entities import Entity, Provenance
from semmap.schemas.perception import DISPLACED, MISSING, Observations
from semmap.schemas.replies import Sighting

_JUST_NOW_S: Final = 10.0


class Sightings:
    """The times of observations. `record`, `is_missing` and `describe_present` are for the node's thread."""

    def __init__(self, past: HistoryReader) -> None:
        self._past = past
        self._seen_ns: dict[str, int] = {}

    def record(self, seen: Observations) -> None:
        """Store the observations of one frame."""
        self._seen_ns.update((one.entity, seen.stamp_ns) for one in seen.observations if one.entity)

    def is_missing(self, entity: Entity) -> bool:
        """Return whether perception has reported that an entity is not where it should be."""
        return entity.conflict in (MISSING, DISPLACED)

    def describe_present(self, entity: Entity) -> Sighting:
        """Return where an entity of the map is, as far as is known."""
        return self._describe(make_sighting(entity, None), None)

    def describe_removed(self, name: str, entity: Entity | None) -> Sighting:
        """Return where a removed or missing entity was. For any thread. Raises UnknownName."""
        if entity is not None:
            return self._describe(
                make_sighting(entity, None), self._past.in_conflict_since(entity), entity.conflict
            )
        found = self._past.last_seen(name)
        by_sight = found.removed is not None and found.removed.source == "perception"
        return self._describe(found, found.removed if by_sight else None)

    def _describe(self, found: Sighting, missing: Provenance | None, how: str = "") -> Sighting:
        seen_ns = self._seen_ns.get(found.name)
        if seen_ns is not None and seen_ns <= found.provenance.stamp_ns:
            seen_ns = None  # of its former place
        now_ns = time.time_ns()
        if missing is not None:
            text = f"reported missing {_at(missing, now_ns)}: {how or missing.reason}"
        elif found.removed is not None:
            text = f"removed {_at(found.removed, now_ns)} by {_author(found.removed)}"
        else:
            text = _describe_observed(found.provenance, seen_ns, now_ns)
        return structs.replace(found, gone=missing, seen_ns=seen_ns, text=text)


def _describe_observed(placed: Provenance, seen_ns: int | None, now_ns: int) -> str:
    if seen_ns is not None:
        ago_s = (now_ns - seen_ns) / 1e9
        if ago_s < _JUST_NOW_S:
            return "in view of a camera now"
        return f"last in view {wording.duration(ago_s)} ago; not seen since, not reported missing"
    if not placed.commit:
        return "never seen, not reported missing"
    how = "last seen" if placed.source == "perception" else f"placed by {_author(placed)}"
    return f"{how} {_at(placed, now_ns)}; not seen since, not reported missing"


def _at(provenance: Provenance, now_ns: int) -> str:
    """Return `at commit 7, 12 min ago`."""
    return f"at commit {provenance.commit}, {wording.duration((now_ns - provenance.stamp_ns) / 1e9)} ago"


def _author(provenance: Provenance) -> str:
    by = {"operator": "an operator", "file": "a file", "scene": "the scene"}.get(
        provenance.source, provenance.source
    )
    return f"{provenance.source}/{provenance.agent}" if provenance.agent else by
