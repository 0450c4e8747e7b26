"""What a tab shows of each entity and body, and how that is batched: one mesh with many instances a model."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from semmap.nodes.drawing.articulation import JointPositions
from semmap.nodes.drawing.figures import UNKNOWN_SIZE_M, Figure, figure_of, pose_of
from semmap.nodes.drawing.palette import GREY, colour_of
from semmap.nodes.drawing.surfaces import appearance_of
from semmap.nodes.extern.web.scene.meshes import Look, linear, srgb, veiled
from semmap.schemas.entities import Entity, Pose, Size
from semmap.schemas.joints import JOINT_POSITIONS, positions_of
from semmap.schemas.scenes import Body, Surface

Floats = NDArray[np.float32]

BOX: Final = "box"
"""In place of a model: a box of the thing's size."""

SurfaceOf = Callable[[str, Size], Surface | None]
"""The surface of a model at a size, if it is known."""


class Shown(Struct, frozen=True, gc=False):
    """One thing as it is drawn. `size_m` is along its own axes, from its bottom centre up, with all shut."""

    look: Look
    model: str
    size_m: Size
    rgb: tuple[int, int, int]
    pose: Pose
    bends: JointPositions = ()

    @property
    def key(self) -> Key:
        """Those with the same key are one batch: boxes of all sizes are."""
        return (self.look, self.model, UNKNOWN_SIZE_M if self.model == BOX else self.size_m, self.bends)


Key = tuple[Look, str, Size, JointPositions]


class Batch(Struct, frozen=True):
    """Things of one key, as rows: positions and sizes (N, 3) [m], wxyzs (N, 4), sRGB colours (N, 3)."""

    names: tuple[str, ...]
    positions: Floats
    wxyzs: Floats
    sizes: Floats
    colours: NDArray[np.uint8]


def shown(
    entity: Entity | None,
    body: Body | None,
    pose: Pose | None,
    surface_of: SurfaceOf,
    *,
    simulated: bool,
    past: bool = False,
    bends: JointPositions | None = None,
) -> Shown | None:
    """How an entity, a body, or an entity with its body is drawn; None for what is a place or nowhere.

    `pose` is where the body stands by now, and `bends` where its joints do; without them they stand as the
    map states. In the `past` there are entities only.
    """
    figure = figure_of(entity, body, simulated=simulated and not past)
    pose = pose or pose_of(entity, body)
    if figure is None or pose is None or figure.appearance == "place":
        return None
    model = appearance_of(body) if body is not None else _model_of(entity)
    size_m = figure.size_m
    if not model or surface_of(model, size_m) is None:
        model = BOX
    look: Look = "past" if past else _look_of(figure)
    rgb = GREY if figure.appearance == "furniture" else colour_of(figure.class_)
    if model == BOX:
        bends = ()
    elif bends is None:
        bends = _stated(entity)
    return Shown(look, model, size_m, rgb, pose, bends)


def _stated(entity: Entity | None) -> JointPositions:
    """How the map states that joints stand."""
    said = None if entity is None else entity.properties.get(JOINT_POSITIONS)
    if not isinstance(said, str):
        return ()
    return tuple((name, at) for name, at in positions_of(said).items() if at)


def _look_of(figure: Figure) -> Look:
    match figure.appearance:
        case "ghost":
            return "ghost"
        case "believed":
            return "believed"
    return "solid"


def _model_of(entity: Entity | None) -> str:
    if entity is None:
        return ""
    return entity.body.model if entity.body is not None and entity.body.model else entity.model


def by_key(things: Mapping[str, Shown]) -> dict[Key, dict[str, Shown]]:
    """Everything that is shown, by key and by name, in the order of `things`."""
    found: dict[Key, dict[str, Shown]] = {}
    for name, thing in things.items():
        found.setdefault(thing.key, {})[name] = thing
    return found


def batch_of(things: Mapping[str, Shown]) -> Batch:
    """Things of one key as rows, in their order."""
    several = things.values()
    rgb = np.array([thing.rgb for thing in several], dtype=np.uint8)
    (look,) = {thing.look for thing in several}
    return Batch(
        names=tuple(things),
        positions=np.array([thing.pose.position_m for thing in several], dtype=np.float32),
        wxyzs=np.array([thing.pose.orientation_wxyz for thing in several], dtype=np.float32),
        sizes=np.array([thing.size_m for thing in several], dtype=np.float32),
        colours=srgb(veiled(linear(rgb), look)),
    )
