"""Every model: how it is built, what it measures and weighs by default, and its colour."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from nodes.sim_node.models import furniture as f
from nodes.sim_node.models import tableware as t
from nodes.sim_node.models.parts import Colour, Parts, Vec3


class ModelKind(NamedTuple):
    """One row: `parts(x, y, z, colour)` builds it; depth, width and height [m]; mass [kg]."""

    parts: Callable[[float, float, float, Colour], Parts]
    size_m: Vec3
    mass_kg: float
    colour: Colour


MODELS: dict[str, ModelKind] = {
    "chair": ModelKind(f.chair, (0.45, 0.45, 0.90), 5.0, (0.62, 0.40, 0.22)),
    "table": ModelKind(f.table, (0.80, 1.20, 0.75), 22.0, (0.68, 0.48, 0.28)),
    "couch": ModelKind(f.couch, (0.90, 2.00, 0.85), 45.0, (0.36, 0.44, 0.52)),
    "bed": ModelKind(f.bed, (2.00, 1.60, 0.80), 60.0, (0.55, 0.38, 0.24)),
    "bookshelf": ModelKind(f.bookshelf, (0.32, 0.90, 1.80), 30.0, (0.52, 0.34, 0.18)),
    "counter": ModelKind(f.counter, (0.60, 1.60, 0.90), 60.0, (0.35, 0.35, 0.36)),
    "desk": ModelKind(f.desk, (0.70, 1.40, 0.75), 32.0, (0.58, 0.42, 0.28)),
    "cup": ModelKind(t.cup, (0.080, 0.110, 0.095), 0.30, (0.85, 0.35, 0.25)),
    "glass": ModelKind(t.glass, (0.070, 0.070, 0.110), 0.25, (0.70, 0.85, 0.92)),
    "plate": ModelKind(t.plate, (0.260, 0.260, 0.025), 0.50, (0.95, 0.95, 0.93)),
    "bowl": ModelKind(t.bowl, (0.160, 0.160, 0.070), 0.35, (0.35, 0.60, 0.75)),
    "bottle": ModelKind(t.bottle, (0.080, 0.080, 0.280), 0.90, (0.25, 0.55, 0.35)),
    "can": ModelKind(t.can, (0.066, 0.066, 0.120), 0.36, (0.80, 0.15, 0.15)),
    "tray": ModelKind(t.tray, (0.300, 0.450, 0.040), 0.90, (0.60, 0.42, 0.25)),
    "person": ModelKind(f.figure, (0.35, 0.50, 1.72), 72.0, (0.75, 0.30, 0.30)),
}
