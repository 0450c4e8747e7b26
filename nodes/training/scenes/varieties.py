"""What things of a class look like in homes beside our one model of it: other forms, and sizes from to.

Sizes are those of common household things; a cuboid is learnt as a box only where it is not as large as a
box of cereals, a carton of milk or a book would be.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from nodes.sim_node.models.forms import column, shade, shifted, slab, turned
from nodes.sim_node.models.model_table import MODELS
from nodes.sim_node.models.parts import ALONG_X, Colour, Parts, Vec3, about, ball, box, felt, pill, rod, seen

Form = Callable[[float, float, float, Colour], Parts]
"""Builds a thing of given depth, width and height [m]."""


class Variety(NamedTuple):
    """Things that a model stands for, from the smallest to the largest [m]; round ones as deep as wide."""

    model: str
    form: Form
    low_m: Vec3
    high_m: Vec3
    round: bool = False


def any_size(variety: Variety, rng: np.random.Generator) -> Vec3:
    """A size between its smallest and its largest, in proportion more than in extent."""
    low, high = np.log(variety.low_m), np.log(variety.high_m)
    whole = rng.random()
    share = np.clip(whole + rng.normal(0.0, 0.2, 3), 0.0, 1.0)
    x, y, z = np.exp(low + share * (high - low)).tolist()
    return (x, x, z) if variety.round else (x, y, z)


def carton(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A closed cuboid with its flaps seen."""
    return [
        slab(x, y, 0.0, z, colour),
        *seen(box((0.97 * x, 0.97 * y, 0.001), (0.0, 0.0, z), shade(colour, 0.9))),
    ]


def flat_bottle(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Of shampoo, mustard or oil: a flat body with rounded sides, shoulders, a cap."""
    body, cap = 0.72 * z, min(x, y) * 0.28
    rounded = min(x, y) / 2
    sides = max(x, y) - 2 * rounded
    along = (1.0, 0.0) if x > y else (0.0, 1.0)
    ends = [
        shifted([column(rounded, 0.0, body, colour)], x=s * sides / 2 * along[0], y=s * sides / 2 * along[1])
        for s in (-1, 1)
    ]
    middle = (
        max(sides * along[0], x - 2 * rounded * along[0]),
        max(sides * along[1], y - 2 * rounded * along[1]),
    )
    return [
        slab(*middle, 0.0, body, colour),
        *(part for end in ends for part in end),
        *seen(ball((0.9 * x, 0.9 * y, 0.34 * z), (0.0, 0.0, 0.70 * z), colour)),
        column(cap, body, z, shade(colour, 0.5)),
    ]


def spray_bottle(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A body that narrows, and a head with a nozzle and a trigger towards +x."""
    radius = min(0.8 * x, y) / 2
    neck, dark = 0.35 * radius, shade(colour, 0.4)
    return shifted(
        [
            column(radius, 0.0, 0.55 * z, colour),
            *turned([(radius, 0.55 * z), (neck, 0.78 * z)], colour, steps=6),
            *felt(column(neck, 0.55 * z, 0.8 * z, colour)),
            column(neck, 0.76 * z, 0.86 * z, dark),
            *seen(box((x - 0.6 * radius, 0.7 * neck, 0.12 * z), (x / 2 - radius / 2, 0.0, 0.93 * z), dark)),
            *seen(
                box(
                    (0.2 * radius, 0.5 * neck, 0.16 * z),
                    (0.9 * radius, 0.0, 0.80 * z),
                    dark,
                    about("y", -0.4),
                )
            ),
        ],
        x=radius - x / 2,
    )


def drink_can(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Narrower at both ends."""
    radius = min(x, y) / 2
    return [
        column(radius, 0.06 * z, 0.9 * z, colour),
        *turned([(0.8 * radius, 0.0), (radius, 0.06 * z)], colour, steps=3),
        *turned([(radius, 0.9 * z), (0.8 * radius, z)], colour, steps=3),
        *felt(column(0.9 * radius, 0.0, z, colour)),
    ]


def tumbler(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A cup without a handle, wider at the top, with a floor."""
    radius, wall = min(x, y) / 2, 0.07 * min(x, y) / 2
    shell = MODELS["glass"].parts(x, y, z, colour)
    return [*shell, *seen(column(0.76 * radius, 0.0, 2 * wall, shade(colour, 0.8)))]


def wine_glass(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A foot, a stem and a bowl."""
    radius = min(x, y) / 2
    bowl = [(0.1 * radius, 0.46 * z), (0.8 * radius, 0.6 * z), (radius, 0.75 * z), (0.8 * radius, z)]
    return [
        column(0.9 * radius, 0.0, 0.02 * z, colour),
        column(0.1 * radius, 0.0, 0.5 * z, colour),
        *turned(bowl, colour, steps=6),
        *felt(column(0.9 * radius, 0.5 * z, z, colour)),
    ]


def teapot(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A round body with a spout towards +y, a handle and a lid."""
    radius = min(x, 0.62 * y) / 2
    body = (2 * radius, 2 * radius, 0.82 * z)
    return [
        ball(body, (0.0, 0.0, 0.41 * z), colour),
        *seen(pill(0.16 * radius, 0.24 * y, (0.0, 0.5 * y - 0.1 * y, 0.55 * z), colour, about("x", -0.7))),
        *seen(pill(0.12 * radius, 0.45 * z, (0.0, 0.1 * radius - 0.5 * y, 0.5 * z), colour)),
        *seen(rod(0.1 * radius, 0.2 * y, (0.0, -0.38 * y, 0.66 * z), colour, about("x", math.pi / 2))),
        *seen(rod(0.1 * radius, 0.2 * y, (0.0, -0.38 * y, 0.32 * z), colour, about("x", math.pi / 2))),
        *seen(column(0.5 * radius, 0.75 * z, 0.88 * z, shade(colour, 0.9))),
        *seen(ball((0.3 * radius, 0.3 * radius, 0.14 * z), (0.0, 0.0, 0.93 * z), colour)),
    ]


def skillet(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A pan with low walls and one long handle towards +x."""
    radius = min(0.31 * x, y / 2)
    side = radius - x / 2
    return [
        *shifted([column(0.9 * radius, 0.0, 0.12 * z, colour)], x=side),
        *shifted(turned([(0.86 * radius, 0.1 * z), (radius, 0.85 * z)], shade(colour, 1.2), steps=4), x=side),
        *seen(
            pill(
                0.09 * radius,
                x - 2 * radius,
                (radius + (x - 2 * radius) / 2 + side, 0.0, 0.8 * z),
                colour,
                ALONG_X,
            )
        ),
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
    Variety("can", drink_can, (0.050, 0.050, 0.085), (0.070, 0.070, 0.175), round=True),
    Variety("bottle", _own("bottle"), (0.045, 0.045, 0.140), (0.110, 0.110, 0.340), round=True),
    Variety("bottle", flat_bottle, (0.035, 0.060, 0.120), (0.070, 0.110, 0.280)),
    Variety("bottle", spray_bottle, (0.075, 0.060, 0.180), (0.120, 0.100, 0.300)),
    Variety("wine_bottle", _own("wine_bottle"), (0.062, 0.062, 0.230), (0.090, 0.090, 0.340), round=True),
    Variety("cup", _own("cup"), (0.050, 0.070, 0.050), (0.100, 0.140, 0.130)),
    Variety("cup", tumbler, (0.050, 0.050, 0.045), (0.110, 0.110, 0.130), round=True),
    Variety("glass", _own("glass"), (0.050, 0.050, 0.080), (0.090, 0.090, 0.180), round=True),
    Variety("glass", wine_glass, (0.055, 0.055, 0.130), (0.100, 0.100, 0.240), round=True),
    Variety("bowl", _own("bowl"), (0.090, 0.090, 0.040), (0.280, 0.280, 0.130), round=True),
    Variety("plate", _own("plate"), (0.140, 0.140, 0.012), (0.310, 0.310, 0.035), round=True),
    Variety("pan", skillet, (0.28, 0.16, 0.035), (0.52, 0.34, 0.080)),
    Variety("pot", _own("pot"), (0.14, 0.20, 0.08), (0.30, 0.42, 0.26)),
    Variety("kettle", teapot, (0.10, 0.16, 0.09), (0.18, 0.28, 0.20)),
    Variety("pitcher", _own("pitcher"), (0.10, 0.13, 0.16), (0.17, 0.22, 0.30)),
    Variety("jar", _own("jar"), (0.050, 0.050, 0.060), (0.130, 0.130, 0.220), round=True),
    Variety("vase", _own("vase"), (0.080, 0.080, 0.150), (0.220, 0.220, 0.400), round=True),
    Variety("ball", _own("ball"), (0.040, 0.040, 0.040), (0.250, 0.250, 0.250), round=True),
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
    Variety("bread", _own("bread"), (0.08, 0.16, 0.06), (0.15, 0.36, 0.13)),
)

_LIKE = 0.22
_NO_BOX = tuple(
    np.log(np.sort(MODELS[name].size_m)) for name in ("cereals", "carton", "book", "soap", "pill_box")
)


def is_like_another(variety: Variety, size_m: Vec3) -> bool:
    """Whether a cuboid of this size would rather be of a class that has a cuboid's form, too."""
    logs = np.log(np.sort(size_m))
    return variety.form is carton and any(np.abs(logs - other).max() < _LIKE for other in _NO_BOX)
