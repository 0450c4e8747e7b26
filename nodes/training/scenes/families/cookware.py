"""Pots, teapots, pans."""

from __future__ import annotations

import math

import numpy as np

from semmap.nodes.sim_node.models.forms import shade
from semmap.nodes.sim_node.models.parts import Colour, Parts
from semmap.nodes.training.scenes.families.lots import Lots
from semmap.nodes.training.scenes.families.walls import handle, radius_at, wall
from semmap.nodes.training.scenes.solids import full, hollow, lathe, lump, smooth, tube


def pot(lots: Lots, colour: Colour) -> Parts:
    """With a lid or none, with ears or one long handle."""
    radius = lots(0.06, 0.15)
    z = radius * lots(0.6, 1.5)
    outside = wall(radius, radius * lots.even(0.85, 1.0), z, 0.0)
    lidded, dark = lots.chance(0.55), lots.other(colour)
    solids = [lathe(full(outside) if lidded else hollow(outside, lots(0.002, 0.005), 0.06 * z)).part(colour)]
    if lidded:
        high, knob = z * lots.even(0.04, 0.2), radius * lots.even(0.12, 0.22)
        dome = smooth([(1.03 * radius, 0.98 * z), (0.8 * radius, z + 0.7 * high), (knob, z + high)])
        solids += [
            lathe(full(dome)).part(shade(colour, lots(0.8, 1.2))),
            lump(2 * knob, 2 * knob, 1.4 * knob).moved(z=z + 0.9 * high).part(dark),
        ]
    at = z * lots.even(0.6, 0.9)
    if lots.chance(0.4):
        length = radius * lots.even(1.0, 2.0)
        path = np.array([(0.0, 0.97 * radius, at), (0.0, radius + length, at + length * lots.even(0.0, 0.3))])
        solids.append(tube(path, radius * lots(0.07, 0.12)).part(dark))
    else:
        reach = radius * lots.even(0.15, 0.35)
        ear = np.array(
            smooth(
                [
                    (-0.35 * radius, 0.9 * radius, at),
                    (-0.3 * radius, radius + reach, at),
                    (0.3 * radius, radius + reach, at),
                    (0.35 * radius, 0.9 * radius, at),
                ]
            )
        )
        for half_turn in (0.0, math.pi):
            solids.append(tube(ear, radius * lots(0.05, 0.08)).turned("z", half_turn).part(dark))
    return solids


def teapot(lots: Lots, colour: Colour) -> Parts:
    """With a spout, a lid, a handle behind or above."""
    radius = lots(0.045, 0.11)
    z = radius * lots(1.2, 2.2)
    mouth = radius * lots.even(0.35, 0.7)
    outside = smooth(
        [
            (radius * lots.even(0.5, 0.95), 0.0),
            (radius, 0.2 * z),
            (radius * lots.even(0.9, 1.05), z * lots.even(0.4, 0.65)),
            (1.2 * mouth, 0.92 * z),
            (mouth, z),
        ]
    )
    dark, knob = lots.other(colour), mouth * lots.even(0.2, 0.4)
    low, long = z * lots.even(0.25, 0.5), radius * lots.even(0.5, 1.0)
    start = radius_at(outside, low) - 0.1 * radius
    tip = (0.0, start + 0.1 * radius + long, z * lots.even(0.75, 1.0))
    spout = smooth(
        [
            (0.0, start, low),
            (0.0, start + 0.6 * long, low + 0.2 * (tip[2] - low)),
            (0.0, start + 0.8 * long, low + 0.7 * (tip[2] - low)),
            tip,
        ]
    )
    thick = radius * lots.even(0.14, 0.28)
    solids = [
        lathe(full(outside)).part(colour),
        lathe(full(smooth([(1.05 * mouth, 0.99 * z), (0.8 * mouth, 1.06 * z), (knob, 1.1 * z)]))).part(
            colour
        ),
        lump(2 * knob, 2 * knob, 2 * knob).moved(z=1.08 * z).part(dark),
        tube(np.array(spout), np.linspace(thick, 0.5 * thick, len(spout))).part(colour),
    ]
    if lots.chance(0.6):
        heights = (z * lots.even(0.2, 0.4), z * lots.even(0.7, 0.92))
        grip = handle(outside, heights, radius * lots.even(0.4, 0.8), radius * lots(0.07, 0.14), square=False)
        solids.append(grip.turned("z", math.pi).part(dark))
    else:
        up, wide = z * lots.even(1.3, 1.7), 0.75 * radius
        arch = smooth([(0.0, -wide, 0.85 * z), (0.0, -wide, up), (0.0, wide, up), (0.0, wide, 0.85 * z)])
        solids.append(tube(np.array(arch), radius * lots(0.06, 0.1)).part(dark))
    return solids


def pan(lots: Lots, colour: Colour) -> Parts:
    """Shallow, with one long handle."""
    radius, z = lots(0.08, 0.16), lots(0.03, 0.075)
    outside = smooth([(radius * lots.even(0.65, 0.9), 0.0), (0.95 * radius, 0.35 * z), (radius, z)])
    length, at = radius * lots.even(1.0, 1.9), z * lots.even(0.6, 0.95)
    rise, thick = length * lots.even(-0.02, 0.3), lots(0.007, 0.014)
    path = np.array(
        smooth(
            [
                (0.93 * radius, 0.0, at),
                (radius + 0.3 * length, 0.0, at + 0.6 * rise),
                (radius + length, 0.0, at + rise),
            ]
        )
    )
    grip = (
        tube(path, np.linspace(0.7 * thick, thick, len(path)))
        .moved(z=-at)
        .scaled(y=lots.even(1.0, 1.8))
        .moved(z=at)
    )
    return [
        lathe(hollow(outside, lots(0.002, 0.004), min(0.004, 0.2 * z)), slices=28).part(colour),
        grip.part(lots.other(colour)),
    ]
