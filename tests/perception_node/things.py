"""A table with things that perception sees perfectly, and a map that applies all commands."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

from msgspec import structs

from semmap.nodes.perception_node.config import TrackingConfig
from semmap.nodes.perception_node.tracking.association import associate
from semmap.nodes.perception_node.tracking.class_hierarchy import ClassHierarchy
from semmap.nodes.perception_node.tracking.observed_images import NO_IMAGES, ObservedImages
from semmap.nodes.perception_node.tracking.occupancy import Occupancy
from semmap.nodes.perception_node.tracking.tracks import Tracks
from semmap.schemas.commands import Add, Command, Remove, Update
from semmap.schemas.entities import Entity, Pose, Provenance, Size, Source, orientation_from_yaw
from semmap.schemas.perception import Observation

CONFIG = TrackingConfig(
    confirm_frames=3,
    vague_frames=3,
    clear_frames=3,
    rest_frames=2,
    nudge_frames=5,
    gone_frames=4,
    odd_frames=6,
)
SIZES: dict[str, Size] = {
    "Cup": (0.08, 0.08, 0.1),
    "Bottle": (0.07, 0.07, 0.28),
    "Book": (0.16, 0.24, 0.03),
    "Object": (0.3, 0.12, 0.15),
}
CLASSES = ClassHierarchy(
    {
        "Object": frozenset({"Physical_Thing"}),
        "Tableware": frozenset({"Object", "Physical_Thing"}),
        "Cup": frozenset({"Tableware", "Object", "Physical_Thing"}),
        "Bottle": frozenset({"Object", "Physical_Thing"}),
        "Book": frozenset({"Object", "Physical_Thing"}),
    },
    {"Cup": "cup"},
    {"Cup": SIZES["Cup"]},
)


def at(x: float, y: float, z: float = 0.7, yaw: float = 0.0) -> Pose:
    return Pose(position_m=(x, y, z), orientation_wxyz=orientation_from_yaw(yaw))


def seen(class_: str, pose: Pose, size_m: Size | None = None, *, p=0.9, whole=True) -> Observation:
    return Observation(
        class_=class_,
        probability=p,
        candidates={class_: p},
        pose=pose,
        size_m=size_m or SIZES[class_],
        points=500,
        whole=whole,
    )


def entity(
    name: str,
    class_: str,
    pose: Pose | None,
    size_m: Size | None = None,
    *,
    source: Source = "operator",
    confidence: float | None = None,
    **more,
) -> Entity:
    said = Provenance(commit=1, stamp_ns=1, source=source, confidence=confidence)
    return Entity(
        name=name,
        class_=class_,
        iri=f"http://example.org/{name}",
        types=(class_,),
        pose=pose,
        size_m=size_m or SIZES[class_],
        provenance=said,
        pose_provenance=said,
        shape_provenance=said,
        reference_provenance=said,
        **more,
    )


@dataclass
class Table:
    """`things` are on the table, and `entities` are in the map."""

    things: list[Observation] = field(default_factory=list)
    entities: dict[str, Entity] = field(default_factory=dict)
    tracks: Tracks = field(default_factory=Tracks)
    config: TrackingConfig = CONFIG
    images: ObservedImages = NO_IMAGES
    hidden: bool = False
    """Make the occupancy of all places unknown."""

    def look(self) -> tuple[Command, ...]:
        """Process one frame, apply the commands to the map, and return them."""
        result = associate(
            self.entities, self.tracks, self.things, self._occupancy, CLASSES, self.config, self.images
        )
        self.tracks, self.taken_for = result.tracks, result.entities
        for command in result.commands:
            self._obey(command)
        return result.commands

    def observe(self, count: int) -> list[Command]:
        return [command for _ in range(count) for command in self.look()]

    def told(self, entities: Iterable[Entity]) -> Table:
        self.entities |= {e.name: e for e in entities}
        return self

    def _occupancy(self, pose: Pose, size_m: Size) -> Occupancy:
        if self.hidden:
            return "unknown"
        return "occupied" if any(_fills(thing, pose, size_m) for thing in self.things) else "free"

    def _obey(self, command: Command) -> None:
        assert command.source == "perception"
        assert command.agent
        match command:
            case Add():
                assert command.name not in self.entities
                assert command.at is not None
                pose = Pose(position_m=command.at, orientation_wxyz=command.orientation)
                made = entity(
                    command.name,
                    command.class_,
                    pose,
                    command.size,
                    source="perception",
                    confidence=command.confidence,
                )
                self.entities[command.name] = structs.replace(made, preferred_reference=command.ref)
            case Remove():
                for name in command.names:
                    assert self.entities.pop(name).shape_provenance.source == "perception"
            case Update():
                self.entities[command.name] = self._updated(self.entities[command.name], command)

    def _updated(self, old: Entity, command: Update) -> Entity:
        operators = old.shape_provenance.source == "operator"
        assert not (operators and (command.class_ or command.size or command.ref or command.alt))
        pose = old.pose
        if command.at is not None:
            pose = Pose(position_m=command.at, orientation_wxyz=command.orientation)
        conflict = old.conflict if command.conflict is None else command.conflict
        return structs.replace(
            old,
            pose=pose,
            size_m=command.size or old.size_m,
            class_=command.class_ or old.class_,
            preferred_reference=command.ref or old.preferred_reference,
            conflict=conflict,
        )


def _fills(thing: Observation, pose: Pose, size_m: Size) -> bool:
    """Return whether an unrotated thing is in the place of another, and not much smaller."""
    (x, y, z), (u, v, w) = thing.pose.position_m, pose.position_m
    there = math.dist((x, y, z), (u, v, w)) < max(size_m[:2]) / 2
    inside = abs(x - u) < thing.size_m[0] / 2 and abs(y - v) < thing.size_m[1] / 2 and z == w
    return (there or inside) and all(
        own > 0.5 * wanted for own, wanted in zip(thing.size_m, size_m, strict=True)
    )
