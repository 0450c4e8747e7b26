"""Bottles, jars, cans, vases, flower pots: what holds something and has no handle."""

from __future__ import annotations

from semmap.nodes.sim_node.models.parts import Colour, Parts
from semmap.nodes.training.scenes.families.random_values import RandomValues
from semmap.nodes.training.scenes.solids import full, hollow, lathe, smooth


def bottle(draw: RandomValues, colour: Colour) -> Parts:
    """Round or flat, with or without shoulders, a waist, a cap."""
    z = draw(0.12, 0.34)
    radius = min(z * draw(0.11, 0.33), 0.08)
    neck = radius * draw(0.25, 0.6)
    shoulder, base = z * draw.even(0.35, 0.8), radius * draw.even(0.85, 1.0)
    slope = min(z * draw.even(0.04, 0.3), 0.94 * z - shoulder)
    waist = radius * (draw.even(0.8, 1.0) if draw.chance(0.4) else 1.0)
    cap_radius, cap = neck * draw.even(1.0, 1.4), z * draw.even(0.03, 0.14)
    outside = smooth(
        [
            (base, 0.0),
            (radius, 0.06 * z),
            (waist, 0.5 * shoulder),
            (radius, 0.9 * shoulder),
            (radius, shoulder),
            (neck + 0.4 * (radius - neck) * draw.even(0.5, 1.5), shoulder + 0.6 * slope),
            (neck, shoulder + slope),
            (neck, z - 0.3 * cap),
        ]
    )
    flat = draw.even(0.5, 0.9) if draw.chance(0.35) else 1.0
    solids = [lathe(full(outside)).scaled(y=flat).part(colour)]
    if draw.chance(0.85):
        lid = lathe(full([(cap_radius, z - cap), (cap_radius, z)]))
        solids.append(lid.scaled(y=max(flat, 0.7)).part(draw.other(colour)))
    return solids


def wine_bottle(draw: RandomValues, colour: Colour) -> Parts:
    """Slim, with high shoulders."""
    z, radius = draw(0.26, 0.34), draw(0.033, 0.044)
    neck, shoulder = radius * draw(0.32, 0.45), z * draw.even(0.48, 0.66)
    slope = z * draw.even(0.06, 0.2)
    outside = smooth(
        [
            (0.95 * radius, 0.0),
            (radius, 0.03 * z),
            (radius, shoulder),
            (0.5 * (radius + neck), shoulder + 0.6 * slope),
            (neck, shoulder + slope),
            (neck, 0.97 * z),
            (1.15 * neck, z),
        ]
    )
    return [lathe(full(outside)).part(colour)]


def jar(draw: RandomValues, colour: Colour) -> Parts:
    """Stout, with a lid."""
    radius = draw(0.026, 0.07)
    z = radius * draw(1.4, 3.4)
    lid_radius, lid = radius * draw.even(0.7, 1.03), z * draw.even(0.1, 0.26)
    outside = smooth(
        [
            (0.93 * radius, 0.0),
            (radius, 0.08 * z),
            (radius * draw.even(0.93, 1.04), 0.5 * z),
            (radius, (z - lid) * draw.even(0.8, 0.95)),
            (0.96 * lid_radius, z - lid),
        ]
    )
    return [
        lathe(full(outside)).part(colour),
        lathe(full([(lid_radius, z - lid), (lid_radius, 0.97 * z), (0.95 * lid_radius, z)])).part(
            draw.other(colour)
        ),
    ]


def drink_can(draw: RandomValues, colour: Colour) -> Parts:
    """Narrower at both ends, its top sunk."""
    radius = draw(0.025, 0.035)
    z, neck = radius * draw(2.6, 5.2), radius * draw.even(0.78, 0.96)
    taper = z * draw.even(0.05, 0.12)
    outside = smooth(
        [(0.8 * radius, 0.0), (radius, 0.5 * taper), (radius, 0.5 * z), (radius, z - taper), (neck, z)], 1
    )
    return [lathe(hollow(outside, 0.05 * radius, z - draw.even(0.002, 0.006))).part(colour)]


def food_can(draw: RandomValues, colour: Colour) -> Parts:
    """With rims, sometimes with a lid of another colour."""
    radius = draw(0.03, 0.08)
    z, rim = radius * draw(0.6, 3.4), radius * draw.even(1.0, 1.04)
    edge = min(0.004, 0.1 * z)
    outside = [
        (rim, 0.0),
        (rim, edge),
        (radius, 1.5 * edge),
        (radius, z - 1.5 * edge),
        (rim, z - edge),
        (rim, z),
    ]
    sunk = draw.even(0.001, 0.006)
    solids = [lathe(hollow(outside, 0.05 * radius, z - sunk)).part(colour)]
    if draw.chance(0.3):  # a plastic lid
        solids.append(
            lathe(full([(1.02 * rim, z - 2 * edge), (1.02 * rim, 1.01 * z)])).part(draw.other(colour))
        )
    return solids


def vase(draw: RandomValues, colour: Colour) -> Parts:
    """With a belly and a neck."""
    z = draw(0.13, 0.4)
    radius = min(z * draw(0.16, 0.42), 0.12)
    neck = radius * draw.even(0.28, 0.75)
    outside = smooth(
        [
            (radius * draw.even(0.4, 0.85), 0.0),
            (radius, z * draw.even(0.25, 0.5)),
            (0.6 * radius + 0.4 * neck, z * draw.even(0.55, 0.7)),
            (neck, z * draw.even(0.75, 0.9)),
            (min(neck * draw.even(1.0, 1.9), radius), z),
        ]
    )
    return [lathe(hollow(outside, 0.004, 0.04 * z)).part(colour)]


def flower_pot(draw: RandomValues, colour: Colour) -> Parts:
    """With a rim, filled to some height."""
    radius = draw(0.045, 0.13)
    z = radius * draw(1.2, 2.2)
    bottom, rim = radius * draw.even(0.58, 0.85), radius * draw.even(0.9, 1.0)
    edge = z * draw.even(0.12, 0.28)
    outside = [(bottom, 0.0), (rim * 0.97, z - edge), (radius, z - edge), (radius, z)]
    return [lathe(hollow(outside, 0.07 * radius, z * draw.even(0.1, 0.85))).part(colour)]
