"""Drawable objects for entities and bodies, and their batches: one mesh with many instances per model."""

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
from semmap.nodes.extern.web.scene.meshes import Appearance, linear, srgb, tinted
from semmap.ontology.model_shapes import is_same_size
from semmap.schemas.entities import Entity, Pose, Size, Vector
from semmap.schemas.joints import JOINT_POSITIONS, positions_of
from semmap.schemas.scenes import Body, Surface

Floats = NDArray[np.float32]

BOX: Final = "box"
"""Used instead of a model: a box of the size of the object."""

SurfaceOf = Callable[[str, Size], Surface | None]
"""Returns the surface of a model at a size; None if it is not known."""


class Drawable(Struct, frozen=True, gc=False):
    """One object as it is drawn. `size_m` is the extent along its own axes with all joints closed."""

    appearance: Appearance
    model: str
    size_m: Size
    rgb: tuple[int, int, int]
    pose: Pose
    joint_positions: JointPositions = ()

    @property
    def key(self) -> Key:
        """The key of its batch; boxes of all sizes share one."""
        return (
            self.appearance,
            self.model,
            UNKNOWN_SIZE_M if self.model == BOX else self.size_m,
            self.joint_positions,
        )


def middle_of(pose: Pose, size_m: Size) -> Vector:
    """Return the centre of an object."""
    x, y, z = pose.position_m
    return (x, y, z + size_m[2] / 2.0)


def top_of(pose: Pose, size_m: Size) -> Vector:
    """Return the position of a label above an object."""
    x, y, z = pose.position_m
    return (x, y, z + size_m[2] + 0.05)


def label_of(name: str, thing: Drawable) -> tuple[str, Vector]:
    """Return the name of an object, with a question mark if it has no body, and its position."""
    return (f"{name}?" if thing.appearance == "believed" else name, top_of(thing.pose, thing.size_m))


Key = tuple[Appearance, str, Size, JointPositions]


class Batch(Struct, frozen=True):
    """Objects with one key: positions and sizes (N, 3) [m], wxyzs (N, 4), sRGB colours (N, 3)."""

    names: tuple[str, ...]
    positions: Floats
    wxyzs: Floats
    sizes: Floats
    colours: NDArray[np.uint8]


def drawable_of(
    entity: Entity | None,
    body: Body | None,
    pose: Pose | None,
    surface_of: SurfaceOf,
    *,
    simulated: bool,
    past: bool = False,
    joint_positions: JointPositions | None = None,
    present: Body | None = None,
) -> Drawable | None:
    """Return how an entity, a body, or both together are drawn; None for places and without a pose.

    `pose` and `joint_positions` are the current pose and joint positions of the body; by default those of the
    map are used. In the `past` there are entities only. One is drawn like its `present` body of the world
    file, if that has its size.
    """
    figure = figure_of(entity, body, simulated=simulated and not past)
    pose = pose or pose_of(entity, body)
    if figure is None or pose is None or figure.appearance == "place":
        return None
    model = appearance_of(body) if body is not None else _model_of(entity)
    size_m = figure.size_m
    if body is None and present is not None and _is_same(entity, present):
        model, size_m = present.surface, present.size_m
    if not model or surface_of(model, size_m) is None:
        model = BOX
    appearance: Appearance = "past" if past else _appearance_of(figure)
    rgb = GREY if figure.appearance == "furniture" else colour_of(figure.class_)
    if model == BOX:
        joint_positions = ()
    elif joint_positions is None:
        joint_positions = _asserted_joint_positions(entity)
    return Drawable(appearance, model, size_m, rgb, pose, joint_positions)


def _asserted_joint_positions(entity: Entity | None) -> JointPositions:
    """Return the joint positions in the map."""
    text = None if entity is None else entity.properties.get(JOINT_POSITIONS)
    if not isinstance(text, str):
        return ()
    return tuple((name, at) for name, at in positions_of(text).items() if at)


def _appearance_of(figure: Figure) -> Appearance:
    match figure.appearance:
        case "ghost":
            return "ghost"
        case "believed":
            return "believed"
    return "solid"


def _is_same(entity: Entity | None, present: Body) -> bool:
    """Return whether an entity of the past has the shape of a body of the world file."""
    if entity is None or not present.surface:
        return False
    return entity.size_m is None or is_same_size(entity.size_m, present.size_m)


def _model_of(entity: Entity | None) -> str:
    if entity is None:
        return ""
    return entity.body.model if entity.body is not None and entity.body.model else entity.model


def by_key(things: Mapping[str, Drawable]) -> dict[Key, dict[str, Drawable]]:
    """Return the objects by key and name, in the order of `things`."""
    found: dict[Key, dict[str, Drawable]] = {}
    for name, thing in things.items():
        found.setdefault(thing.key, {})[name] = thing
    return found


def batch_of(things: Mapping[str, Drawable]) -> Batch:
    """Return the batch of objects with the same key, in their order."""
    objects = things.values()
    rgb = np.array([thing.rgb for thing in objects], dtype=np.uint8)
    (appearance,) = {thing.appearance for thing in objects}
    return Batch(
        names=tuple(things),
        positions=np.array([thing.pose.position_m for thing in objects], dtype=np.float32),
        wxyzs=np.array([thing.pose.orientation_wxyz for thing in objects], dtype=np.float32),
        sizes=np.array([thing.size_m for thing in objects], dtype=np.float32),
        colours=srgb(tinted(linear(rgb), appearance)),
    )
