"""Models as plain data: primitive parts in metres, the origin at the bottom centre, the front at +x."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Vec3 = tuple[float, float, float]
Quat = tuple[float, float, float, float]
Colour = tuple[float, float, float]

UPRIGHT: Quat = (1.0, 0.0, 0.0, 0.0)


class Shape(Enum):
    """The primitives, with the meaning of `half` for each."""

    BOX = "box"  # half extents
    ELLIPSOID = "ellipsoid"  # semi-axes
    CYLINDER = "cylinder"  # radius, radius, half height along its own z
    CAPSULE = "capsule"  # radius, radius, half height of the straight part
    MESH = "mesh"  # half extents of its bounding box, which is centred on the part


class Role(Enum):
    """The purpose of a part."""

    BOTH = "both"  # visible and colliding
    VISUAL = "visual"  # visible, does not collide
    COLLISION = "collision"  # invisible, collides in place of visible parts


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles: `vertices` (N, 3) [m] relative to the centre of their bounding box, `faces` (M, 3)."""

    key: str
    vertices: Floats
    faces: NDArray[np.int32]


@dataclass(frozen=True)
class Joint:
    """How some parts of a model move relative to the others; they are drawn with the joint at 0.

    A hinge turns about `axis` through `anchor` [m], a slide shifts along it. `range` is from the minimum to
    the maximum position [rad, m], and `closed` is the closed end of it; without limits both are None, and it
    opens nothing. `friction` [N m, N] holds it in place.
    """

    name: str
    kind: Literal["hinge", "slide"]
    anchor: Vec3
    axis: Vec3
    range: tuple[float, float] | None
    closed: float | None = 0.0
    friction: float = 0.5
    switch: bool = False


@dataclass(frozen=True)
class Cavity:
    """The interior of a part that is solid in the simulator, such as a pot; `is_open` at the top, or closed.

    Its floor is at the share `floor` of the height of the part, above the thickness of a wall.
    """

    is_open: bool
    floor: float = 0.0


@dataclass(frozen=True)
class Part:
    """One primitive or mesh of a model; `centre` and `half` in metres, `turn` a unit quaternion wxyz.

    Parts that move together have equal joints.
    """

    shape: Shape
    half: Vec3
    centre: Vec3
    colour: Colour
    turn: Quat = UPRIGHT
    role: Role = Role.BOTH
    mesh: Mesh | None = None
    joint: Joint | None = None
    cavity: Cavity | None = None

    @property
    def volume(self) -> float:
        """Return the volume [m^3]."""
        a, b, c = self.half
        match self.shape:
            case Shape.BOX | Shape.MESH:
                return 8.0 * a * b * c
            case Shape.ELLIPSOID:
                return 4.0 / 3.0 * math.pi * a * b * c
            case Shape.CYLINDER:
                return 2.0 * math.pi * a * a * c
            case Shape.CAPSULE:
                return math.pi * a * a * (2.0 * c + 4.0 / 3.0 * a)

    def reach(self) -> Floats:
        """Return half extents (3,) of its axis-aligned bounding box in the model's axes [m]."""
        rotation = rotation_matrix(self.turn)
        radial, half = np.abs(rotation), np.asarray(self.half)
        match self.shape:
            case Shape.MESH if self.mesh is not None:
                return np.asarray(np.abs(self.mesh.vertices @ rotation.T).max(axis=0))
            case Shape.BOX | Shape.MESH:
                return np.asarray(radial @ half)
            case Shape.ELLIPSOID:
                return np.asarray(np.sqrt((rotation**2) @ half**2))
            case Shape.CYLINDER:
                return np.asarray(
                    half[0] * np.sqrt(np.maximum(0.0, 1.0 - radial[:, 2] ** 2)) + half[2] * radial[:, 2]
                )
            case Shape.CAPSULE:
                return np.asarray(half[0] + half[2] * radial[:, 2])


Parts = list[Part]


def box(size: Sequence[float], centre: Vec3, colour: Colour, turn: Quat = UPRIGHT) -> Part:
    """Return a box of full extents `size`."""
    x, y, z = size
    return Part(Shape.BOX, (x / 2, y / 2, z / 2), centre, colour, turn)


def ball(size: Sequence[float], centre: Vec3, colour: Colour, turn: Quat = UPRIGHT) -> Part:
    """Return an ellipsoid of full extents `size`."""
    x, y, z = size
    return Part(Shape.ELLIPSOID, (x / 2, y / 2, z / 2), centre, colour, turn)


def rod(radius: float, height: float, centre: Vec3, colour: Colour, turn: Quat = UPRIGHT) -> Part:
    """Return a cylinder along its z axis."""
    return Part(Shape.CYLINDER, (radius, radius, height / 2), centre, colour, turn)


def pill(radius: float, height: float, centre: Vec3, colour: Colour, turn: Quat = UPRIGHT) -> Part:
    """Return a capsule along its z axis, `height` long from tip to tip."""
    straight = max(height / 2 - radius, 1e-4)
    return Part(Shape.CAPSULE, (radius, radius, straight), centre, colour, turn)


def mesh(vertices: Floats, faces: NDArray[np.int32], colour: Colour, role: Role = Role.BOTH) -> Part:
    """Return triangles with `vertices` (N, 3) at their positions [m], without a key."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    middle, half = (low + high) / 2.0, (high - low) / 2.0
    triangles = Mesh("", vertices - middle, np.asarray(faces, dtype=np.int32))
    return Part(Shape.MESH, _vec3(half), _vec3(middle), colour, role=role, mesh=triangles)


def with_cavity(part: Part, *, is_open: bool, floor: float = 0.0) -> Part:
    """Return the part with an interior for relations. It remains solid in the simulator."""
    return replace(part, cavity=Cavity(is_open, floor))


def visual(parts: Part | Iterable[Part]) -> Parts:
    """Return the parts as visual parts."""
    return _with_role(parts, Role.VISUAL)


def collision(parts: Part | Iterable[Part]) -> Parts:
    """Return the parts as invisible collision parts."""
    return _with_role(parts, Role.COLLISION)


def _with_role(parts: Part | Iterable[Part], role: Role) -> Parts:
    return [replace(part, role=role) for part in ([parts] if isinstance(parts, Part) else parts)]


def about(axis: str, angle_rad: float) -> Quat:
    """Return the rotation by `angle_rad` about the axis x, y or z."""
    vector = [math.sin(angle_rad / 2) if axis == name else 0.0 for name in "xyz"]
    return (math.cos(angle_rad / 2), vector[0], vector[1], vector[2])


ALONG_X: Quat = about("y", math.pi / 2)
ALONG_Y: Quat = about("x", -math.pi / 2)


def quarter_turned(parts: Iterable[Part]) -> Parts:
    """Return the model rotated by -90 degrees about z, so that its front is at -y."""
    turn = about("z", -math.pi / 2)

    def turned(vector: Vec3) -> Vec3:
        return (vector[1], -vector[0], vector[2])

    return [
        replace(
            part,
            centre=turned(part.centre),
            turn=product(turn, part.turn),
            joint=part.joint
            and replace(part.joint, anchor=turned(part.joint.anchor), axis=turned(part.joint.axis)),
        )
        for part in parts
    ]


def moving(joint: Joint, parts: Part | Iterable[Part]) -> Parts:
    """Return the parts, moved by a joint."""
    return [replace(part, joint=joint) for part in ([parts] if isinstance(parts, Part) else parts)]


def moved(part: Part, position: float) -> Part:
    """Return a part with its joint at `position` [rad, m]."""
    joint = part.joint
    if joint is None or position == 0.0:
        return part
    axis, anchor, centre = (np.asarray(v) for v in (joint.axis, joint.anchor, part.centre))
    if joint.kind == "slide":
        return replace(part, centre=_vec3(centre + position * axis))
    x, y, z = math.sin(position / 2) * axis
    turn: Quat = (math.cos(position / 2), float(x), float(y), float(z))
    centre = anchor + rotation_matrix(turn) @ (centre - anchor)
    return replace(part, centre=_vec3(centre), turn=product(turn, part.turn))


def product(a: Quat, b: Quat) -> Quat:
    """Return the rotation b followed by the rotation a."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


def rotation_matrix(turn: Sequence[float]) -> Floats:
    """Return the (3, 3) rotation of a unit quaternion wxyz."""
    w, x, y, z = turn
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def bounds(parts: Iterable[Part]) -> tuple[Floats, Floats]:
    """Return lowest and highest corner, each (3,) [m], of the box around all parts."""
    pairs = [(np.asarray(part.centre), part.reach()) for part in parts]
    low = np.min([centre - reach for centre, reach in pairs], axis=0)
    high = np.max([centre + reach for centre, reach in pairs], axis=0)
    return low, high


@dataclass(frozen=True)
class Inertial:
    """Mass [kg], centre of mass (3,) [m] from the bottom centre, and moments of inertia [kg m^2] about it."""

    mass_kg: float
    centre_m: Vec3
    moments: Vec3


def inertial(parts: Iterable[Part], mass_kg: float) -> Inertial:
    """Return the inertia of the colliding parts as solids of one density.

    Products of inertia are omitted: the models are nearly symmetric, and MuJoCo is fastest for a body whose
    frame is its centre of mass with diagonal inertia.
    """
    solid = [part for part in parts if part.role is not Role.VISUAL]
    volumes = np.array([part.volume for part in solid])
    masses = mass_kg * volumes / volumes.sum()
    centres = np.array([part.centre for part in solid])
    centre = masses @ centres / mass_kg
    moments = np.zeros(3)
    for part, mass, offset in zip(solid, masses, centres - centre, strict=True):
        x, y, z = part.reach()
        own = mass / 3.0 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])
        moments += own + mass * (offset @ offset - offset**2)
    return Inertial(mass_kg, _vec3(centre), _vec3(_realisable(moments)))


def _realisable(moments: Floats) -> Floats:
    """Raise moments that are so small relative to the others that contacts would oscillate."""
    return np.asarray(np.maximum(np.maximum(moments, 0.02 * moments.max()), 1e-7))


def _vec3(values: Floats) -> Vec3:
    return (float(values[0]), float(values[1]), float(values[2]))
