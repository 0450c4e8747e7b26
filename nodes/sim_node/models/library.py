"""Builds a model by name and size, and validates it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from semmap.nodes.sim_node.models.forms import shifted
from semmap.nodes.sim_node.models.model_table import ModelKind
from semmap.nodes.sim_node.models.parts import (
    Inertial,
    Joint,
    Part,
    Role,
    Vec3,
    bounds,
    box,
    collision,
    inertial,
    quarter_turned,
)
from semmap.nodes.sim_node.models.variety_table import KINDS

FALLBACK_M: Vec3 = (0.3, 0.3, 0.3)
"""The size of a box for a class without a model and an entity without a size."""

SIZES_M = (0.001, 100.0)
"""Limits of a body's size along any axis."""

DENSITY = 150.0
"""Default density [kg/m^3 of the bounding box]: most things are hollow."""

_HOLDS, _GRAVITY = 1.3, 9.81
"""A joint's friction exceeds the torque of gravity by this factor, so that a lid stays in place."""

_BOX_COLOUR = (0.72, 0.66, 0.58)


class ModelError(ValueError):
    """A body of this model and size cannot be created; the text is the reason."""


@dataclass(frozen=True)
class Leaf:
    """A part that one joint moves, such as a door or a drawer, and its inertia."""

    joint: Joint
    parts: tuple[Part, ...]
    inertial: Inertial


@dataclass(frozen=True)
class Model:
    """A model at one size: its parts, inertia, and actual size along its own axes [m].

    With joints, `inertial` is that of the fixed parts, which come first.
    """

    name: str
    parts: tuple[Part, ...]
    inertial: Inertial
    size_m: Vec3
    leaves: tuple[Leaf, ...] = ()
    notes: tuple[str, ...] = ()
    """What of its file is omitted, or does not move: one clause each."""

    @property
    def mass_kg(self) -> float:
        """Return the total mass."""
        return self.inertial.mass_kg + sum(leaf.inertial.mass_kg for leaf in self.leaves)

    @property
    def frame(self) -> tuple[Part, ...]:
        """Return the fixed parts."""
        return tuple(part for part in self.parts if part.joint is None) if self.leaves else self.parts


@lru_cache(maxsize=1024)
def build(name: str, size_m: Vec3 | None) -> Model:
    """Build the model `name` at `size_m`, or at its own size; a box if there is no such model.

    If the size is long where the model is wide, the model is rotated by a quarter turn. The mass is
    proportional to the volume. Raises ModelError for an invalid size.
    """
    check_size(size_m)
    kind = KINDS.get(name)
    if kind is None:
        return _plain_box(size_m or FALLBACK_M)
    x, y, z = size_m or kind.size_m
    if turned := _is_turned(kind, (x, y, z)):
        x, y = y, x
    parts = kind.parts(x, y, z, kind.colour)
    if turned:
        parts = quarter_turned(parts)
    standard = kind.size_m[0] * kind.size_m[1] * kind.size_m[2]
    return assemble(name, parts, kind.mass_kg * x * y * z / standard)


def check_size(size_m: Sequence[float] | None, hint: str = "") -> None:
    """Raise ModelError for an invalid size; its text ends with `hint`."""
    low, high = SIZES_M
    for extent in size_m or ():
        if not low <= extent <= high:
            raise ModelError(
                f"a size must be from {low:g} to {high:g} m along each axis, not {extent:g} m{hint}"
            )


def _is_turned(kind: ModelKind, size_m: Vec3) -> bool:
    own_x, own_y, _ = kind.size_m
    x, y, _ = size_m
    return (own_x - own_y) * (x - y) < 0.0 and max(own_x, own_y) > 1.3 * min(own_x, own_y)


def _plain_box(size_m: Vec3) -> Model:
    x, y, z = size_m
    return assemble("box", [box(size_m, (0.0, 0.0, z / 2), _BOX_COLOUR)], DENSITY * x * y * z)


def assemble(name: str, parts: Sequence[Part], mass_kg: float, notes: tuple[str, ...] = ()) -> Model:
    """Return parts as a model, moved so that the origin is the bottom centre.

    The mass is distributed by the volumes of the colliding parts.
    """
    low, high = bounds(parts)
    parts = shifted(parts, x=-(low[0] + high[0]) / 2, y=-(low[1] + high[1]) / 2, z=-low[2])
    low, high = bounds(parts)
    mass_kg = min(max(mass_kg, 0.002), 5000.0)
    frame = [part for part in parts if part.joint is None]
    joints = dict.fromkeys(part.joint for part in parts if part.joint is not None)
    share = mass_kg / sum(part.volume for part in parts if part.role is not Role.VISUAL)
    leaves = tuple(_leaf(joint, [part for part in parts if part.joint == joint], share) for joint in joints)
    return Model(
        name=name,
        parts=(*frame, *(part for leaf in leaves for part in leaf.parts)),
        inertial=_weighed(frame, share) if leaves else inertial(parts, mass_kg),
        size_m=(float(high[0] - low[0]), float(high[1] - low[1]), float(high[2] - low[2])),
        leaves=leaves,
        notes=notes,
    )


def _leaf(joint: Joint, parts: Sequence[Part], density: float) -> Leaf:
    weighed = _weighed(parts, density)
    joint = replace(joint, friction=max(joint.friction, _HOLDS * _torque(joint, weighed)))
    return Leaf(joint, tuple(replace(part, joint=joint) for part in parts), weighed)


def _torque(joint: Joint, weighed: Inertial) -> float:
    """Return the maximum torque of gravity on a hinge [N m], or its force on a slide [N]."""
    weight = _GRAVITY * weighed.mass_kg
    if joint.kind == "slide":
        return weight * abs(joint.axis[2])
    axis, arm = np.asarray(joint.axis), np.subtract(weighed.centre_m, joint.anchor)
    return weight * float(np.linalg.norm(np.cross(axis, arm)) * np.hypot(axis[0], axis[1]))


def _weighed(parts: Sequence[Part], density: float) -> Inertial:
    """Return the inertia of colliding parts; without any, of a gram at the visible parts."""
    volume = sum(part.volume for part in parts if part.role is not Role.VISUAL)
    if volume == 0.0:
        parts = collision(parts)
    return inertial(parts, max(density * volume, 0.001))
