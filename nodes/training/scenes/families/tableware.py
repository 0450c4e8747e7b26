"""Cups, glasses, bowls, plates, pitchers."""

from __future__ import annotations

import math

from semmap.nodes.sim_node.models.parts import Colour, Parts
from semmap.nodes.training.scenes.families.random_values import RandomValues
from semmap.nodes.training.scenes.families.walls import handle, wall
from semmap.nodes.training.scenes.solids import Profile, full, hollow, lathe, smooth


def cup(draw: RandomValues, colour: Colour) -> Parts:
    """Conical, straight or bulging, most with a handle."""
    radius = draw(0.026, 0.06)
    with_grip = draw.chance(0.7)
    z = radius * (draw(1.1, 2.7) if with_grip else draw(1.0, 2.2))
    outside = wall(radius, radius * draw.even(0.55, 1.02), z, radius * draw.even(-0.06, 0.12))
    body = lathe(hollow(outside, draw(0.0015, 0.005), 0.05 * z))
    solids = [body.part(colour)]
    if with_grip:
        heights = (z * draw.even(0.12, 0.42), z * draw.even(0.65, 0.92))
        grip = handle(
            outside,
            heights,
            radius * draw.even(0.3, 0.75),
            radius * draw(0.07, 0.16),
            square=draw.chance(0.4),
        )
        solids.append(grip.part(colour))
    return solids


def glass(draw: RandomValues, colour: Colour) -> Parts:
    """A tumbler."""
    radius = draw(0.025, 0.046)
    z = radius * draw(2.2, 4.4)
    outside = wall(radius, radius * draw.even(0.62, 1.0), z, radius * draw.even(-0.04, 0.06))
    return [lathe(hollow(outside, draw(0.001, 0.004), draw.even(0.03, 0.1) * z)).part(colour)]


def stem_glass(draw: RandomValues, colour: Colour) -> Parts:
    """A bowl on a stem and a foot."""
    radius = draw(0.026, 0.05)
    z = draw(0.12, 0.24)
    stem, foot = z * draw.even(0.22, 0.55), radius * draw.even(0.65, 1.1)
    thin, mouth = draw(0.003, 0.006), radius * draw.even(0.6, 1.05)
    bowl = z - stem
    profile: Profile = [
        (0.0, 0.0),
        (foot, 0.0),
        (foot, 0.003),
        (2.0 * thin, 0.1 * stem),
        (thin, 0.3 * stem),
        (thin, 0.95 * stem),
        *smooth([(thin, stem), (0.8 * radius, stem + 0.12 * bowl), (radius, stem + 0.45 * bowl), (mouth, z)]),
        (mouth - 0.0015, z),
        *smooth(
            [
                (radius - 0.003, stem + 0.45 * bowl),
                (0.75 * radius, stem + 0.17 * bowl),
                (thin, stem + 0.08 * bowl),
            ]
        ),
        (0.0, stem + 0.07 * bowl),
    ]
    return [lathe(profile).part(colour)]


def bowl(draw: RandomValues, colour: Colour) -> Parts:
    """From flat to deep."""
    radius = draw(0.045, 0.15)
    z = radius * draw(0.42, 1.05)
    foot = radius * draw.even(0.3, 0.7)
    full_ness = draw.even(0.35, 0.95)
    outside = smooth(
        [
            (foot, 0.0),
            (foot, 0.04 * z),
            (foot + full_ness * (radius - foot), 0.04 * z + 0.3 * z * draw.even(0.4, 1.2)),
            (radius * draw.even(0.93, 1.0), 0.7 * z),
            (radius, 0.96 * z),
            (radius, z),
        ]
    )
    return [lathe(hollow(outside, draw(0.0015, 0.006), 0.1 * z)).part(colour)]


def plate(draw: RandomValues, colour: Colour) -> Parts:
    """Flat or for soup."""
    radius = draw(0.07, 0.16)
    z, flat = min(draw(0.012, 0.045), 0.3 * radius), radius * draw.even(0.45, 0.8)
    outside = [
        (0.9 * flat, 0.0),
        *smooth([(flat, 0.1 * z), (flat + 0.2 * (radius - flat), 0.5 * z), (radius, z)]),
    ]
    return [lathe(hollow(outside, 0.004, min(0.005, 0.3 * z))).part(colour)]


def pitcher(draw: RandomValues, colour: Colour) -> Parts:
    """Bellied, conical or straight, with a lip and a handle, sometimes with a lid."""
    z = draw(0.13, 0.3)
    radius = min(z * draw(0.24, 0.4), 0.09)
    base, top = radius * draw.even(0.6, 1.0), radius * draw.even(0.5, 1.05)
    belly = z * draw.even(0.2, 0.5)
    outside = smooth(
        [
            (base, 0.0),
            (base, 0.02 * z),
            (radius, belly),
            (0.5 * (radius + top) * draw.even(0.8, 1.0), 0.5 * (belly + z)),
            (top, 0.95 * z),
            (top, z),
        ]
    )
    lidded = draw.chance(0.25)
    profile = full(outside) if lidded else hollow(outside, draw(0.002, 0.005), 0.04 * z)
    lip = draw.even(0.15, 0.5) * top
    body = lathe(profile, slices=28).lipped(lip, draw.even(0.3, 0.7), draw.even(0.55, 0.85))
    heights = (z * draw.even(0.12, 0.4), z * draw.even(0.72, 0.95))
    grip = handle(
        outside, heights, radius * draw.even(0.35, 0.8), radius * draw(0.09, 0.18), square=draw.chance(0.5)
    )
    solids = [
        body.part(colour),
        grip.turned("z", math.pi).part(colour if draw.chance(0.6) else draw.other(colour)),
    ]
    if lidded:
        solids.append(lathe(full([(1.02 * top, 0.98 * z), (1.02 * top, 1.03 * z)])).part(draw.other(colour)))
    return solids
