"""Plants and their pots. Depth x, width y, height z [m]."""

from __future__ import annotations

import math

from semmap.nodes.sim_node.models.forms import WOOD, column, shade, turned
from semmap.nodes.sim_node.models.parts import Colour, Parts, about, ball, collision, product, visual

LEAF: Colour = (0.25, 0.50, 0.20)


def flower_pot(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A clay pot with a rim and earth."""
    radius = min(x, y) / 2
    return [
        *turned([(0.68 * radius, 0), (0.92 * radius, 0.8 * z)], colour, steps=6),
        *collision(column(0.72 * radius, 0, 0.8 * z, colour)),
        column(radius, 0.8 * z, z, shade(colour, 0.9)),
        *visual(column(0.88 * radius, z, z + 0.002, (0.25, 0.17, 0.1))),
    ]


def plant(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A pot with a bush of leaves."""
    radius = 0.3 * min(x, y)
    pot = flower_pot(2 * radius, 2 * radius, 0.3 * z, (0.72, 0.38, 0.24))
    leaves = visual(
        ball(
            (0.5 * x, 0.16 * y, 0.05 * z),
            (0.29 * x * math.cos(a), 0.29 * y * math.sin(a), z * h),
            shade(colour, 0.8 + 0.5 * h),
            product(about("z", a), about("y", -0.7)),
        )
        for h in (0.5, 0.68, 0.82)
        for a in (2 * math.pi * (i + 2 * h) / 6 for i in range(6))
    )
    return [
        *pot,
        *leaves,
        *visual(column(0.012, 0.3 * z, 0.85 * z, WOOD)),
        *visual(ball((0.12 * x, 0.12 * y, 0.3 * z), (0, 0, 0.85 * z), colour)),
        *collision(column(0.8 * radius, 0.3 * z, 0.9 * z, colour)),
    ]


def flower(x: float, y: float, z: float, colour: Colour) -> Parts:
    """One bloom on a stalk in a small pot."""
    pot = min(x, y) * 0.6
    bloom = 0.93 * z
    petals = visual(
        ball(
            (0.42 * x, 0.24 * y, 0.03 * z),
            (0.29 * x * math.cos(a), 0.29 * y * math.sin(a), bloom + 0.02 * z),
            colour,
            product(about("z", a), about("y", -0.35)),
        )
        for a in (2 * math.pi * i / 7 for i in range(7))
    )
    return [
        *flower_pot(pot, pot, 0.28 * z, (0.72, 0.38, 0.24)),
        *visual(column(0.006, 0.28 * z, bloom, LEAF)),
        *petals,
        *visual(ball((0.22 * x, 0.22 * y, 0.08 * z), (0, 0, bloom + 0.02 * z), (0.95, 0.8, 0.25))),
        *visual(
            ball((0.3 * x, 0.1 * y, 0.03 * z), (0.12 * x * s, 0, 0.5 * z), LEAF, about("y", -0.5 * s))
            for s in (-1, 1)
        ),
        *collision(column(0.3 * pot, 0.28 * z, 0.9 * z, colour)),
    ]
