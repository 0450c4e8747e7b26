"""From a model's name and a size to a checked model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from nodes.sim_node.models.parts import Inertial, Part, Vec3, bounds, box, inertial, quarter_turned
from nodes.sim_node.models.table import MODELS, ModelKind

FALLBACK_M: Vec3 = (0.3, 0.3, 0.3)
"""The size of a box for a class without a model and an entity without a size."""

SIZES_M = (0.001, 100.0)
"""What a body may measure along any axis."""

_BOX_DENSITY = 150.0  # kg/m^3: a thing that is mostly hollow
_BOX_COLOUR = (0.72, 0.66, 0.58)


class ModelError(ValueError):
    """A body of this model and size cannot be made; the text says why."""


@dataclass(frozen=True)
class Model:
    """A model at one size: its parts, what they weigh, and their bounding box from `low_m` to `high_m`."""

    name: str
    parts: tuple[Part, ...]
    inertial: Inertial
    low_m: Vec3
    high_m: Vec3

    @property
    def size_m(self) -> Vec3:
        """Real extents along the body's own axes [m]."""
        low, high = self.low_m, self.high_m
        return (high[0] - low[0], high[1] - low[1], high[2] - low[2])


@lru_cache(maxsize=1024)
def build(name: str, size_m: Vec3 | None) -> Model:
    """The model `name` scaled to `size_m`, or at its own size; a box when there is no such model.

    A size that is long where the model is wide is met by turning the model a quarter. Mass grows with
    volume. Raises ModelError for a size that no body can have.
    """
    _check(size_m)
    kind = MODELS.get(name)
    if kind is None:
        return _plain_box(size_m or FALLBACK_M)
    x, y, z = size_m or kind.size_m
    if turned := _is_turned(kind, (x, y, z)):
        x, y = y, x
    parts = kind.parts(x, y, z, kind.colour)
    if turned:
        parts = quarter_turned(parts)
    standard = kind.size_m[0] * kind.size_m[1] * kind.size_m[2]
    return _model(name, parts, kind.mass_kg * x * y * z / standard)


def _check(size_m: Sequence[float] | None) -> None:
    low, high = SIZES_M
    for extent in size_m or ():
        if not low <= extent <= high:
            raise ModelError(f"a body measures {low:g} to {high:g} m along each axis, not {extent:g} m")


def _is_turned(kind: ModelKind, size_m: Vec3) -> bool:
    own_x, own_y, _ = kind.size_m
    x, y, _ = size_m
    return (own_x - own_y) * (x - y) < 0.0 and max(own_x, own_y) > 1.3 * min(own_x, own_y)


def _plain_box(size_m: Vec3) -> Model:
    x, y, z = size_m
    return _model("box", [box(size_m, (0.0, 0.0, z / 2), _BOX_COLOUR)], _BOX_DENSITY * x * y * z)


def _model(name: str, parts: Sequence[Part], mass_kg: float) -> Model:
    low, high = bounds(parts)
    mass_kg = min(max(mass_kg, 0.002), 5000.0)
    return Model(
        name=name,
        parts=tuple(parts),
        inertial=inertial(parts, mass_kg),
        low_m=(float(low[0]), float(low[1]), float(low[2])),
        high_m=(float(high[0]), float(high[1]), float(high[2])),
    )
