"""Identity of moved things: pipeline and association, without Zenoh.

Twenty things stand in cells of a table that two cameras see from opposite corners, noise on. One after the
other is taken to a free cell and turned. Then the entity that stands where the thing really is must be the
one that was it before.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from statistics import mean
from typing import NamedTuple

import numpy as np
from msgspec import structs

from benchmarks.perception.rooms import THIN_M, THINGS
from benchmarks.perception.table import Row
from semmap.nodes.perception_node.config import TrackingConfig
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.pipeline import FrameResult, RecognitionModel, observe_clouds
from semmap.nodes.perception_node.tracking.association import associate
from semmap.nodes.perception_node.tracking.class_hierarchy import ClassHierarchy
from semmap.nodes.perception_node.tracking.occupancy import occupancy_in
from semmap.nodes.perception_node.tracking.tracks import Tracks
from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.sim_node.vision.view import look_at
from semmap.nodes.training.scenes.simulated_scenes import Item, Stage
from semmap.schemas.commands import Add, Command, Remove, Update
from semmap.schemas.entities import Entity, Pose, Provenance

_CELL_M, _COLUMNS, _ROWS = 0.24, 6, 4
TABLE_M = (_COLUMNS * _CELL_M + 0.1, _ROWS * _CELL_M + 0.1, 0.75)
_LARGEST_M = 0.18
_LOOKS = 5
"""The number of observations after each move; five take one second."""
_SAME_M = 0.06
_SEEDS = (5, 6, 7)
CAMERAS = [
    look_at(np.array([side * 0.8, side * 0.8, 1.9]), np.array([0.0, 0.0, 0.75]), 640, 480, math.radians(58.0))
    for side in (-1.0, 1.0)
]


class Kept(NamedTuple):
    """Results of `moves`: `kept` have the same name afterwards, `held` at least an entity."""

    moves: int
    kept: int
    held: int
    entities: int
    """The number of entities at the end."""


def measure(moves: int, learnt: RecognitionModel) -> list[Row]:
    """The rows of the table."""
    classes = ClassHierarchy(
        {name: frozenset(above) for name, above in learnt.ancestors.items()}, {}, learnt.usual_m
    )
    stage = Stage()
    runs = [
        identity(lambda clouds: observe_clouds(clouds, learnt), classes, stage, moves=moves, seed=seed)
        for seed in _SEEDS
    ]
    shares = [run.kept / run.moves for run in runs]
    what = f"identity kept over {moves} moves, 20 objects"
    return [
        Row(f"{what}, mean of {len(runs)} tables", mean(shares), reach=0.95, aim=0.99),
        Row(f"{what}, the worst table", min(shares)),
        Row(f"{what}: of those still seen", sum(run.kept for run in runs) / sum(run.held for run in runs)),
    ]


class ObedientMap:
    """A map that applies all updates of perception."""

    def __init__(self) -> None:
        self.entities: dict[str, Entity] = {}
        self._commit = 0

    def obey(self, command: Command) -> None:
        """Apply a change."""
        self._commit += 1
        said = Provenance(commit=self._commit, stamp_ns=0, source="perception")
        match command:
            case Add(name=str(name), class_=class_, at=at) if at is not None:
                self.entities[name] = Entity(
                    name=name, class_=class_, iri=name, types=(class_,), size_m=command.size,
                    pose=Pose(position_m=at, orientation_wxyz=command.orientation or (1.0, 0.0, 0.0, 0.0)),
                    provenance=said, pose_provenance=said, shape_provenance=said, reference_provenance=said,
                )  # fmt: skip
            case Remove(names=names):
                for name in names:
                    del self.entities[name]
            case Update(name=name):
                self.entities[name] = self._updated(self.entities[name], command)

    def at(self, x: float, y: float) -> str | None:
        """Return the entity nearest to a position on the table, if it is there."""
        distances = {
            math.dist(e.pose.position_m[:2], (x, y)): name
            for name, e in self.entities.items()
            if e.pose is not None and e.pose.position_m[2] > TABLE_M[2] / 2.0
        }
        nearest = min(distances, default=math.inf)
        return distances[nearest] if nearest < _SAME_M else None

    @staticmethod
    def _updated(entity: Entity, command: Update) -> Entity:
        changed = structs.replace(
            entity, class_=command.class_ or entity.class_, size_m=command.size or entity.size_m
        )
        if command.at is None or command.orientation is None:
            return changed
        return structs.replace(
            changed, pose=Pose(position_m=command.at, orientation_wxyz=command.orientation)
        )


def identity(
    perceive: Callable[[Sequence[Cloud]], FrameResult],
    classes: ClassHierarchy,
    stage: Stage,
    *,
    moves: int = 100,
    things: int = 20,
    seed: int,
) -> Kept:
    """Move things and count which ones keep their names."""
    rng, config = np.random.default_rng(seed), TrackingConfig()
    cells = _cells(rng)
    items = [_item(n, cell, rng) for n, cell in enumerate(cells[:things])]
    free = cells[things:]
    semantic_map, tracks = ObedientMap(), Tracks()
    table = Item("table", "table", TABLE_M, (0.6, 0.5, 0.4), (0.0, 0.0, 0.0), 0.0)

    def see(count: int) -> None:
        nonlocal tracks
        bodies = stage.show([table, *items])
        for _ in range(count):
            clouds = stage.shoot(bodies, CAMERAS, rng).clouds
            seen = perceive(clouds).observations.observations
            told = associate(semantic_map.entities, tracks, seen, occupancy_in(clouds), classes, config)
            tracks = told.tracks
            for command in told.commands:
                semantic_map.obey(command)

    def name_of(item: Item) -> str | None:
        return semantic_map.at(*item.position_m[:2])

    see(2 * _LOOKS)
    kept = held = 0
    for _ in range(moves):
        which = int(rng.integers(len(items)))
        before, cell = name_of(items[which]), free.pop(int(rng.integers(len(free))))
        free.append(_cell_of(items[which]))
        items[which] = replace(
            items[which], position_m=_spot(cell, rng), yaw_rad=float(rng.uniform(-3.1, 3.1))
        )
        see(_LOOKS)
        after = name_of(items[which])
        kept += before is not None and after == before
        held += after is not None
    return Kept(moves, kept, held, len(semantic_map.entities))


def things_on_a_table(things: int, rng: np.random.Generator) -> list[Item]:
    """Place each thing in its own cell."""
    return [_item(n, cell, rng) for n, cell in enumerate(_cells(rng)[:things])]


def _cells(rng: np.random.Generator) -> list[tuple[int, int]]:
    cells = [(column, row) for column in range(_COLUMNS) for row in range(_ROWS)]
    rng.shuffle(cells)
    return cells


def _item(number: int, cell: tuple[int, int], rng: np.random.Generator) -> Item:
    small = [
        kind
        for kind in THINGS
        if max(MODELS[kind].size_m[:2]) <= _LARGEST_M and MODELS[kind].size_m[2] > THIN_M
    ]
    kind = str(rng.choice(small))
    x, y, z = (float(own * rng.uniform(0.9, 1.1)) for own in MODELS[kind].size_m)
    red, green, blue = (float(np.clip(c + rng.uniform(-0.1, 0.1), 0.0, 1.0)) for c in MODELS[kind].colour)
    yaw = float(rng.uniform(-3.1, 3.1))
    return Item(f"thing{number}", kind, (x, y, z), (red, green, blue), _spot(cell, rng), yaw)


def _spot(cell: tuple[int, int], rng: np.random.Generator) -> tuple[float, float, float]:
    dx, dy = rng.uniform(-0.02, 0.02, 2).tolist()
    x, y = (
        (n + 0.5) * _CELL_M - many * _CELL_M / 2.0 for n, many in zip(cell, (_COLUMNS, _ROWS), strict=True)
    )
    return (x + dx, y + dy, TABLE_M[2] + 0.001)


def _cell_of(item: Item) -> tuple[int, int]:
    column, row = (
        round((at + many * _CELL_M / 2.0) / _CELL_M - 0.5)
        for at, many in zip(item.position_m, (_COLUMNS, _ROWS), strict=False)
    )
    return (column, row)
