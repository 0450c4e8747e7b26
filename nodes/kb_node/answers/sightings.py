"""When things were last seen, and which are seen to be gone: answers `last-seen`.

Commits tell where a thing was last put or seen to move to. As long as it stays there nothing is committed, so
when a camera last had it in sight is taken from what perception publishes, and kept in memory only.
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
    """What is known of when things were seen. `see`, `is_gone` and `there` are for the node's thread."""

    def __init__(self, past: HistoryReader) -> None:
        self._past = past
        self._seen_ns: dict[str, int] = {}

    def see(self, seen: Observations) -> None:
        """Take note of one look."""
        self._seen_ns.update((one.entity, seen.stamp_ns) for one in seen.observations if one.entity)

    def is_gone(self, entity: Entity) -> bool:
        """Whether perception has said that an entity of the map is not where it should be."""
        return entity.conflict in (MISSING, DISPLACED)

    def there(self, entity: Entity) -> Sighting:
        """Where an entity of the map is, as far as anybody knows."""
        return self._told(make_sighting(entity, None), None)

    def gone(self, name: str, entity: Entity | None) -> Sighting:
        """Where an entity was that was removed, or is seen to be gone. For any thread. Raises UnknownName."""
        if entity is not None:
            return self._told(
                make_sighting(entity, None), self._past.in_conflict_since(entity), entity.conflict
            )
        found = self._past.last_seen(name)
        by_sight = found.removed is not None and found.removed.source == "perception"
        return self._told(found, found.removed if by_sight else None)

    def _told(self, found: Sighting, gone: Provenance | None, how: str = "") -> Sighting:
        seen_ns = self._seen_ns.get(found.name)
        if seen_ns is not None and seen_ns <= found.provenance.stamp_ns:
            seen_ns = None  # of its former place
        now_ns = time.time_ns()
        if gone is not None:
            text = f"seen to be gone {_at(gone, now_ns)}: {how or gone.reason}"
        elif found.removed is not None:
            text = f"removed {_at(found.removed, now_ns)} by {_author(found.removed)}"
        else:
            text = _of_what_is_there(found.provenance, seen_ns, now_ns)
        return structs.replace(found, gone=gone, seen_ns=seen_ns, text=text)


def _of_what_is_there(placed: Provenance, seen_ns: int | None, now_ns: int) -> str:
    if seen_ns is not None:
        ago_s = (now_ns - seen_ns) / 1e9
        if ago_s < _JUST_NOW_S:
            return "in sight of a camera just now"
        return f"last in sight {wording.duration(ago_s)} ago; not seen since, nor seen to be gone"
    if not placed.commit:
        return "neither seen so far nor seen to be gone"
    how = "last seen" if placed.source == "perception" else f"placed by {_author(placed)}"
    return f"{how} {_at(placed, now_ns)}; not seen since, nor seen to be gone"


def _at(said: Provenance, now_ns: int) -> str:
    """`at commit 7, 12 min ago`."""
    return f"at commit {said.commit}, {wording.duration((now_ns - said.stamp_ns) / 1e9)} ago"


def _author(said: Provenance) -> str:
    by = {"operator": "an operator", "file": "a file", "scene": "the scene"}.get(said.source, said.source)
    return f"{said.source}/{said.agent}" if said.agent else by
