"""Varieties of classes with one model: other forms, and ranges of sizes.

Sizes are those of common household objects. A cuboid is used as a box only if its size differs from a box of
cereals, a carton of milk and a book.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from semmap.nodes.sim_node.models.catalogue.other_forms import (
    drink_can,
    flat_bottle,
    skillet,
    spray_bottle,
    teapot,
    tumbler,
    wine_glass,
)
from semmap.nodes.sim_node.models.forms import shade, slab
from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.sim_node.models.parts import Colour, Parts, Vec3, box, visual

Form = Callable[[float, float, float, Colour], Parts]
"""Builds a thing of given depth, width and height [m]."""


class Variety(NamedTuple):
    """Things that a model stands for, from the smallest to the largest [m]; round ones as deep as wide.

    `uneven`: how far a side may be from where the others are between the smallest and the largest.
    """

    model: str
    form: Form
    low_m: Vec3
    high_m: Vec3
    round: bool = False
    uneven: float = 0.2


def any_size(variety: Variety, rng: np.random.Generator) -> Vec3:
    """Return a random size between the smallest and the largest."""
    low, high = np.log(variety.low_m), np.log(variety.high_m)
    whole = rng.random()
    share = np.clip(whole + rng.normal(0.0, variety.uneven, 3), 0.0, 1.0)
    x, y, z = np.exp(low + share * (high - low)).tolist()
    return (x, x, z) if variety.round else (x, y, z)


def carton(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Return a closed box with visible flaps."""
    return [
        slab(x, y, 0.0, z, colour),
        *visual(box((0.97 * x, 0.97 * y, 0.001), (0.0, 0.0, z), shade(colour, 0.9))),
    ]


def _own(model: str) -> Form:
    return MODELS[model].parts


VARIETIES: tuple[Variety, ...] = (
    Variety("box", carton, (0.03, 0.05, 0.03), (0.22, 0.36, 0.30)),
    Variety("box", carton, (0.06, 0.06, 0.02), (0.25, 0.35, 0.08)),
    Variety("box", carton, (0.03, 0.06, 0.10), (0.12, 0.20, 0.26)),
    Variety("book", _own("book"), (0.10, 0.15, 0.010), (0.24, 0.32, 0.060)),
    Variety("book", _own("book"), (0.15, 0.012, 0.17), (0.24, 0.060, 0.32)),
    Variety("can", _own("can"), (0.075, 0.075, 0.030), (0.105, 0.105, 0.055), round=True),
    Variety("can", _own("can"), (0.050, 0.050, 0.080), (0.105, 0.105, 0.150), round=True),
    Variety("can", _own("can"), (0.085, 0.085, 0.095), (0.150, 0.150, 0.190), round=True),
    Variety("can", drink_can, (0.050, 0.050, 0.085), (0.070, 0.070, 0.175), round=True),
    Variety("bottle", _own("bottle"), (0.045, 0.045, 0.140), (0.110, 0.110, 0.340), round=True),
    Variety("bottle", _own("bottle"), (0.110, 0.110, 0.170), (0.160, 0.160, 0.300), round=True),
    Variety("bottle", flat_bottle, (0.035, 0.060, 0.120), (0.070, 0.110, 0.280)),
    Variety("bottle", flat_bottle, (0.055, 0.100, 0.160), (0.090, 0.150, 0.300)),
    Variety("bottle", spray_bottle, (0.075, 0.060, 0.180), (0.120, 0.100, 0.300)),
    Variety("wine_bottle", _own("wine_bottle"), (0.068, 0.068, 0.270), (0.084, 0.084, 0.340), round=True),
    Variety("cup", _own("cup"), (0.050, 0.070, 0.050), (0.100, 0.140, 0.130)),
    Variety("cup", tumbler, (0.050, 0.050, 0.045), (0.110, 0.110, 0.130), round=True),
    Variety("glass", _own("glass"), (0.050, 0.050, 0.080), (0.090, 0.090, 0.180), round=True),
    Variety("glass", wine_glass, (0.055, 0.055, 0.130), (0.100, 0.100, 0.240), round=True),
    Variety("bowl", _own("bowl"), (0.090, 0.090, 0.040), (0.280, 0.280, 0.130), round=True),
    Variety("plate", _own("plate"), (0.140, 0.140, 0.012), (0.310, 0.310, 0.035), round=True),
    Variety("pan", skillet, (0.28, 0.16, 0.035), (0.52, 0.34, 0.080)),
    Variety("pan", _own("pan"), (0.28, 0.16, 0.040), (0.50, 0.34, 0.075)),
    Variety("pot", _own("pot"), (0.14, 0.20, 0.08), (0.30, 0.42, 0.26)),
    Variety("kettle", teapot, (0.10, 0.16, 0.09), (0.18, 0.28, 0.20)),
    Variety("pitcher", _own("pitcher"), (0.10, 0.13, 0.16), (0.17, 0.22, 0.30)),
    Variety("pitcher", _own("cup"), (0.110, 0.140, 0.180), (0.160, 0.210, 0.290)),
    Variety("jar", _own("jar"), (0.050, 0.050, 0.060), (0.130, 0.130, 0.220), round=True),
    Variety("vase", _own("vase"), (0.080, 0.080, 0.150), (0.220, 0.220, 0.400), round=True),
    Variety("ball", _own("ball"), (0.038, 0.038, 0.037), (0.075, 0.075, 0.074), round=True, uneven=0.03),
    Variety("ball", _own("ball"), (0.062, 0.062, 0.060), (0.120, 0.120, 0.118), round=True, uneven=0.03),
    Variety("ball", _own("ball"), (0.100, 0.100, 0.096), (0.250, 0.250, 0.245), round=True, uneven=0.03),
    Variety("toilet_paper", _own("toilet_paper"), (0.090, 0.090, 0.080), (0.130, 0.130, 0.240), round=True),
    Variety("knife", _own("knife"), (0.18, 0.018, 0.010), (0.34, 0.045, 0.022)),
    Variety("spoon", _own("spoon"), (0.14, 0.030, 0.010), (0.34, 0.075, 0.040)),
    Variety("fork", _own("fork"), (0.15, 0.020, 0.010), (0.26, 0.036, 0.022)),
    Variety("screwdriver", _own("screwdriver"), (0.14, 0.022, 0.022), (0.28, 0.042, 0.042)),
    Variety("wrench", _own("wrench"), (0.14, 0.030, 0.010), (0.28, 0.070, 0.022)),
    Variety("hammer", _own("hammer"), (0.22, 0.09, 0.026), (0.36, 0.15, 0.045)),
    Variety("scissors", _own("scissors"), (0.13, 0.060, 0.008), (0.25, 0.110, 0.018)),
    Variety("remote_control", _own("remote_control"), (0.12, 0.035, 0.014), (0.24, 0.060, 0.030)),
    Variety("soap", _own("soap"), (0.045, 0.065, 0.020), (0.080, 0.120, 0.045)),
    Variety("camera", _own("camera"), (0.06, 0.09, 0.06), (0.16, 0.15, 0.11)),
    Variety("candle", _own("candle"), (0.050, 0.050, 0.050), (0.110, 0.110, 0.220), round=True),
    Variety("flower_pot", _own("flower_pot"), (0.090, 0.090, 0.080), (0.260, 0.260, 0.250), round=True),
    Variety("shoes", _own("shoes"), (0.20, 0.16, 0.08), (0.33, 0.28, 0.16)),
    Variety("hat", _own("hat"), (0.24, 0.24, 0.10), (0.38, 0.38, 0.20)),
    Variety("apple", _own("apple"), (0.060, 0.060, 0.058), (0.095, 0.095, 0.095), round=True, uneven=0.1),
    Variety("orange", _own("orange"), (0.055, 0.055, 0.052), (0.100, 0.100, 0.098), round=True, uneven=0.1),
    Variety("pear", _own("pear"), (0.060, 0.060, 0.075), (0.085, 0.085, 0.130), round=True, uneven=0.1),
    Variety("lemon", _own("lemon"), (0.045, 0.060, 0.045), (0.070, 0.100, 0.070)),
    Variety("banana", _own("banana"), (0.050, 0.140, 0.030), (0.095, 0.220, 0.045)),
    Variety("basket", _own("basket"), (0.16, 0.22, 0.09), (0.34, 0.46, 0.28)),
    Variety("tray", _own("tray"), (0.18, 0.25, 0.020), (0.36, 0.48, 0.060)),
    Variety("glasses", _own("glasses"), (0.11, 0.12, 0.035), (0.16, 0.16, 0.060)),
    Variety("headphones", _own("headphones"), (0.07, 0.15, 0.15), (0.11, 0.21, 0.23)),
    Variety("toothbrush", _own("toothbrush"), (0.15, 0.010, 0.012), (0.21, 0.018, 0.024)),
    Variety("bread", _own("bread"), (0.08, 0.16, 0.06), (0.15, 0.36, 0.13)),
)

_LIKE = 0.22
_NO_BOX = tuple(
    np.log(np.sort(MODELS[name].size_m)) for name in ("cereals", "carton", "book", "soap", "pill_box")
)


def is_like_another(variety: Variety, size_m: Vec3) -> bool:
    """Return whether a cuboid of this size is more similar to another box-shaped class."""
    logs = np.log(np.sort(size_m))
    return variety.form is carton and any(np.abs(logs - other).max() < _LIKE for other in _NO_BOX)
