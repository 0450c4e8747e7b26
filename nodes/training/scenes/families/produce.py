"""Fruit and vegetables."""

from __future__ import annotations

import math

import numpy as np

from semmap.nodes.sim_node.models.parts import Colour, Parts
from semmap.nodes.training.scenes.families.random_values import RandomValues
from semmap.nodes.training.scenes.solids import lathe, lump, smooth, tube


def apple(draw: RandomValues, colour: Colour) -> Parts:
    """Dented above and below, hardly ever quite regular."""
    radius = draw(0.03, 0.047)
    z = radius * draw.even(1.55, 1.95)
    dent = z * draw.even(0.05, 0.14)
    outside = smooth(
        [
            (0.0, 0.06 * z),
            (0.35 * radius, 0.0),
            (radius * draw.even(0.75, 0.92), 0.15 * z),
            (1.04 * radius, 0.5 * z),
            (1.04 * radius, z * draw.even(0.65, 0.8)),
            (0.6 * radius, 1.02 * z),
            (0.2 * radius, 1.02 * z),
            (0.0, z - dent),
        ],
        3,
    )
    body = lathe(outside).lumpy(draw.even(0.0, 0.06), draw.rng).turned("x", draw.rng.normal(0.0, 0.12))
    parts = [body.part(colour)]
    if draw.chance(0.4):
        parts.append(
            tube(np.array([(0.0, 0.0, z - dent), (0.003, 0.002, 1.06 * z)]), 0.0015).part((0.3, 0.2, 0.1))
        )
    return parts


def pear(draw: RandomValues, colour: Colour) -> Parts:
    """It stands or lies."""
    radius = draw(0.028, 0.045)
    z = radius * draw.even(2.3, 3.2)
    outside = smooth(
        [
            (0.0, 0.03 * z),
            (0.5 * radius, 0.0),
            (1.03 * radius, 0.12 * z),
            (1.05 * radius, 0.45 * z),
            (radius * draw.even(0.5, 0.72), z * draw.even(0.6, 0.72)),
            (radius * draw.even(0.3, 0.5), 0.98 * z),
            (0.0, z),
        ]
    )
    body = lathe(outside).lumpy(draw.even(0.0, 0.07), draw.rng)
    if draw.chance(0.3):
        path = np.array([(0.0, 0.0, 0.97 * z), (0.003, 0.004, 1.1 * z)])
        stalk = [tube(path, 0.0018)]
    else:
        stalk = []
    solids = [body, *stalk]
    if draw.chance(0.5):  # it lies
        lean = math.pi / 2 + math.atan(0.25)
        solids = [solid.turned("y", lean) for solid in solids]
    return [solid.part(colour if n == 0 else (0.3, 0.2, 0.1)) for n, solid in enumerate(solids)]


def orange(draw: RandomValues, colour: Colour) -> Parts:
    """Nearly a ball."""
    size = draw(0.055, 0.1)
    return [lump(size, size, size * draw.even(0.88, 1.0)).lumpy(draw.even(0.0, 0.05), draw.rng).part(colour)]


def lemon(draw: RandomValues, colour: Colour) -> Parts:
    """It lies, a nipple at each end."""
    radius = draw(0.023, 0.034)
    long = radius * draw.even(2.5, 3.2)
    nipple = radius * draw.even(0.15, 0.3)
    half = [
        (0.0, 0.0),
        (nipple, 0.01 * long),
        (nipple, 0.08 * long),
        (0.85 * radius, 0.25 * long),
        (1.05 * radius, 0.5 * long),
    ]
    outside = smooth([*half, *((r, long - z) for r, z in reversed(half[:-1]))])
    return [lathe(outside).lumpy(0.03, draw.rng).turned("x", math.pi / 2).part(colour)]


def other_fruit(draw: RandomValues, colour: Colour) -> Parts:
    """Plums, peaches, kiwis, strawberries."""
    radius = draw(0.017, 0.042)
    if draw.chance(0.35):  # pointed
        outside = smooth(
            [
                (0.0, 0.0),
                (0.9 * radius, 0.1 * radius),
                (radius, 0.7 * radius),
                (0.55 * radius, 1.7 * radius),
                (0.0, 2.2 * radius),
            ]
        )
        lean = draw.even(0.0, 2.0)
        return [lathe(outside).lumpy(0.08, draw.rng).turned("x", lean).part(colour)]
    long = radius * draw.even(1.8, 2.6)
    return [
        lump(2 * radius, long, 2 * radius * draw.even(0.85, 1.0))
        .lumpy(draw.even(0.02, 0.08), draw.rng)
        .part(colour)
    ]


def potato(draw: RandomValues, colour: Colour) -> Parts:
    """A lump."""
    x = draw(0.04, 0.075)
    return [
        lump(x, x * draw(1.1, 1.9), x * draw.even(0.7, 0.95))
        .lumpy(draw.even(0.08, 0.25), draw.rng)
        .part(colour)
    ]


def onion(draw: RandomValues, colour: Colour) -> Parts:
    """A bulb with a tip."""
    radius = draw(0.025, 0.048)
    z = radius * draw.even(1.6, 2.5)
    outside = smooth(
        [
            (0.0, 0.0),
            (0.4 * radius, 0.0),
            (1.06 * radius, 0.25 * z),
            (0.95 * radius, 0.62 * z),
            (0.2 * radius, 0.8 * z),
            (0.08 * radius, z),
            (0.0, z),
        ]
    )
    return [lathe(outside).lumpy(0.04, draw.rng).part(colour)]
