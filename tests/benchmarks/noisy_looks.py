"""Noisy observations of twenty objects at rest: counts relations that appear and disappear.

The observations pass through perception's tracks and map updates.
"""

from __future__ import annotations

import random

from msgspec import structs

from benchmarks.relations.situations import TABLE, on_table, place, tall, thing
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.perception_node.config import TrackingConfig
from semmap.nodes.perception_node.tracking.class_hierarchy import ClassHierarchy
from semmap.nodes.perception_node.tracking.map_updates import additions, update_of
from semmap.nodes.perception_node.tracking.tracks import Track
from semmap.schemas.commands import Update
from semmap.schemas.entities import Entity, Pose, Provenance
from semmap.schemas.perception import Observation

LOOKS_A_SECOND = 2.0
POSITION_M, SIZE_M = 0.004, 0.003
"""Standard deviations of one observation, which tracks average; two views differ by 3 mm in the median."""
_SEEN = Provenance(commit=1, stamp_ns=0, source="perception")


def _things() -> list[Entity]:
    """On a table and a stool: apart, side by side, stacked, in a bowl and half over the edge."""
    thin = tall("newspaper")
    return [
        *(on_table(f"cup{n}", x=-0.3, y=0.16 * n - 0.4) for n in range(1, 5)),
        *(on_table(f"can{n}", x=0.0, y=0.1 * n - 0.5) for n in range(1, 5)),
        *(on_table(f"box{n}", y=0.15, z=0.1 * n, size=(0.2, 0.2, 0.1)) for n in range(3)),
        on_table("newspaper1", x=0.2, y=-0.2),
        on_table("book1", x=0.2, y=-0.2, z=thin),
        on_table("glass1", x=0.2, y=-0.2, z=thin + 0.03),
        on_table("plate1", x=0.2, y=0.35),
        on_table("bowl1", x=0.2, y=0.35, z=0.018),
        on_table("orange1", x=0.2, y=0.35, z=0.03),
        on_table("tray1", x=0.38, y=0.05),
        thing("book2", (0.0, 0.85, tall("stool"))),
        thing("bottle1", (0.0, 0.85, tall("stool") + 0.03)),
    ]


def gone(seconds: float = 120.0, seed: int = 1) -> tuple[int, int]:
    """How many facts went again, and how many hold in the end."""
    dice = random.Random(seed)
    config, classes = TrackingConfig(), ClassHierarchy()
    facts, true = Facts(), _things()
    facts.update([place("room1", (0.0, 0.0, 0.0), (4.0, 4.0, 2.5)), TABLE, thing("stool1", (0.0, 0.85, 0.0))])
    tracks = {entity.name: _first(_look(entity, dice), config) for entity in true}
    known: dict[str, Entity] = {}
    went = 0
    for _ in range(int(seconds * LOOKS_A_SECOND)):
        changed = []
        for entity in true:
            track = tracks[entity.name] = tracks[entity.name].see(_look(entity, dice), config)
            before = known.get(entity.name)
            if before is None and track.frames >= config.confirm_frames:
                (added,) = additions([track], set(), classes).values()
                assert added.at is not None
                pose = Pose(position_m=added.at, orientation_wxyz=added.orientation or (1.0, 0.0, 0.0, 0.0))
                changed.append(_seen(entity, pose=pose, size_m=added.size))
            elif before is not None:
                command = update_of(before, track, classes, config)
                if isinstance(command, Update) and (command.at or command.size):
                    at = command.at or before.pose.position_m  # type: ignore[union-attr]
                    pose = Pose(position_m=at, orientation_wxyz=before.pose.orientation_wxyz)  # type: ignore[union-attr]
                    changed.append(structs.replace(before, pose=pose, size_m=command.size or before.size_m))
        known.update((entity.name, entity) for entity in changed)
        went += len(facts.update(changed).gone)
    return went, sum(1 for _ in facts)


def _seen(entity: Entity, **fields: object) -> Entity:
    """As perception adds it: of its own measures."""
    return structs.replace(
        entity, pose_provenance=_SEEN, shape_provenance=_SEEN, reference_provenance=_SEEN, **fields
    )


def _look(entity: Entity, dice: random.Random) -> Observation:
    assert entity.pose is not None
    assert entity.size_m is not None
    x, y, z = (p + dice.gauss(0.0, POSITION_M) for p in entity.pose.position_m)
    wide, deep, high = (max(0.005, s + dice.gauss(0.0, SIZE_M)) for s in entity.size_m)
    return Observation(
        class_=entity.class_,
        probability=0.9,
        pose=Pose(position_m=(x, y, z), orientation_wxyz=entity.pose.orientation_wxyz),
        size_m=(wide, deep, high),
        points=500,
    )


def _first(seen: Observation, config: TrackingConfig) -> Track:
    return Track(seen.pose, seen.size_m).see(seen, config)
