"""Spatulas, ladles, screwdrivers, sponges."""

from __future__ import annotations

import math

import numpy as np

from semmap.nodes.sim_node.models.parts import Colour, Parts, box
from semmap.nodes.training.scenes.families.random_values import RandomValues
from semmap.nodes.training.scenes.solids import full, hollow, lathe, lump, smooth, tube


def spatula(draw: RandomValues, colour: Colour) -> Parts:
    """Spatulas, turners and scrapers: a flat blade on a long handle, lying."""
    long, wide = draw(0.22, 0.38), draw(0.045, 0.1)
    blade, thin = long * draw.even(0.2, 0.38), draw(0.002, 0.006)
    height, thick = draw(0.008, 0.03), draw(0.005, 0.012)
    path = np.array(
        smooth(
            [
                (blade, 0.0, 2 * thin),
                (1.2 * blade, 0.0, height),
                (0.6 * long, 0.0, height),
                (long, 0.0, max(thick, 0.7 * height)),
            ]
        )
    )
    return [
        box((blade, wide, thin), (blade / 2, 0.0, thin / 2 + 0.001), colour),
        tube(path, np.linspace(0.6 * thick, thick, len(path))).part(draw.other(colour)),
    ]


def ladle(draw: RandomValues, colour: Colour) -> Parts:
    """Ladles and slotted spoons: a round bowl on a long handle, lying."""
    long, radius = draw(0.22, 0.36), draw(0.03, 0.055)
    deep, thick = radius * draw.even(0.35, 0.9), draw(0.004, 0.008)
    outside = smooth([(0.2 * radius, 0.0), (0.8 * radius, 0.3 * deep), (radius, deep)])
    path = np.array(
        smooth([(0.95 * radius, 0.0, 0.9 * deep), (1.6 * radius, 0.0, deep + 0.02), (long, 0.0, thick)])
    )
    return [
        lathe(hollow(outside, 0.002, 0.003)).part(colour),
        tube(path, thick).part(colour if draw.chance(0.6) else draw.other(colour)),
    ]


def screwdriver(draw: RandomValues, colour: Colour) -> Parts:
    """Lying, its handle of some profile."""
    long = draw(0.13, 0.3)
    grip, thick = long * draw.even(0.32, 0.55), draw(0.009, 0.02)
    handle = smooth(
        [
            (0.0, 0.0),
            (0.8 * thick, 0.0),
            (thick, 0.2 * grip),
            (thick * draw.even(0.75, 1.0), 0.65 * grip),
            (0.6 * thick, grip),
            (0.0, grip),
        ]
    )
    shaft = thick * draw(0.16, 0.35)
    facets = 6 if draw.chance(0.5) else 14
    solids = [
        (lathe(handle, slices=facets), colour),
        (
            lathe(full([(shaft, 0.95 * grip), (shaft, 0.96 * long), (0.5 * shaft, long)]), slices=8),
            (0.6, 0.6, 0.62),
        ),
    ]
    sunk = math.asin(min(0.9, (thick - shaft) / long))  # its tip touches the ground
    return [
        solid.turned("y", math.pi / 2 + sunk * draw.even(0.0, 1.0)).part(shown) for solid, shown in solids
    ]


def sponge(draw: RandomValues, colour: Colour) -> Parts:
    """A soft cuboid, flat or on its edge."""
    long = draw(0.07, 0.14)
    x, z = long * draw(0.45, 0.8), draw(0.02, 0.05)
    if draw.chance(0.35):  # on its edge
        x, z = z, x
    return [lump(x, long, z, square=draw.even(0.25, 0.5)).lumpy(0.02, draw.rng).part(colour)]
