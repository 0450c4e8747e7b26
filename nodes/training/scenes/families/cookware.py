"""Pots, teapots, pans."""

from __future__ import annotations

import math

import numpy as np

from semmap.nodes.sim_node.models.forms import shade
from semmap.nodes.sim_node.models.parts import Colour, Parts
from semmap.nodes.training.scenes.families.random_values import RandomValues
from semmap.nodes.training.scenes.families.walls import handle, radius_at, wall
from semmap.nodes.training.scenes.solids import full, hollow, lathe, lump, smooth, tube


def pot(draw: RandomValues, colour: Colour) -> Parts:
    """With a lid or none, with ears or one long handle."""
    radius = draw(0.06, 0.15)
    z = radius * draw(0.6, 1.5)
    outside = wall(radius, radius * draw.even(0.85, 1.0), z, 0.0)
    lidded, dark = draw.chance(0.55), draw.other(colour)
    solids = [lathe(full(outside) if lidded else hollow(outside, draw(0.002, 0.005), 0.06 * z)).part(colour)]
    if lidded:
        high, knob = z * draw.even(0.04, 0.2), radius * draw.even(0.12, 0.22)
        dome = smooth([(1.03 * radius, 0.98 * z), (0.8 * radius, z + 0.7 * high), (knob, z + high)])
        solids += [
            lathe(full(dome)).part(shade(colour, draw(0.8, 1.2))),
            lump(2 * knob, 2 * knob, 1.4 * knob).moved(z=z + 0.9 * high).part(dark),
        ]
    at = z * draw.even(0.6, 0.9)
    if draw.chance(0.4):
        length = radius * draw.even(1.0, 2.0)
        path = np.array([(0.0, 0.97 * radius, at), (0.0, radius + length, at + length * draw.even(0.0, 0.3))])
        solids.append(tube(path, radius * draw(0.07, 0.12)).part(dark))
    else:
        reach = radius * draw.even(0.15, 0.35)
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
            solids.append(tube(ear, radius * draw(0.05, 0.08)).turned("z", half_turn).part(dark))
    return solids


def teapot(draw: RandomValues, colour: Colour) -> Parts:
    """With a spout, a lid, a handle behind or above."""
    radius = draw(0.045, 0.11)
    z = radius * draw(1.2, 2.2)
    mouth = radius * draw.even(0.35, 0.7)
    outside = smooth(
        [
            (radius * draw.even(0.5, 0.95), 0.0),
            (radius, 0.2 * z),
            (radius * draw.even(0.9, 1.05), z * draw.even(0.4, 0.65)),
            (1.2 * mouth, 0.92 * z),
            (mouth, z),
        ]
    )
    dark, knob = draw.other(colour), mouth * draw.even(0.2, 0.4)
    low, long = z * draw.even(0.25, 0.5), radius * draw.even(0.5, 1.0)
    start = radius_at(outside, low) - 0.1 * radius
    tip = (0.0, start + 0.1 * radius + long, z * draw.even(0.75, 1.0))
    spout = smooth(
        [
            (0.0, start, low),
            (0.0, start + 0.6 * long, low + 0.2 * (tip[2] - low)),
            (0.0, start + 0.8 * long, low + 0.7 * (tip[2] - low)),
            tip,
        ]
    )
    thick = radius * draw.even(0.14, 0.28)
    solids = [
        lathe(full(outside)).part(colour),
        lathe(full(smooth([(1.05 * mouth, 0.99 * z), (0.8 * mouth, 1.06 * z), (knob, 1.1 * z)]))).part(
            colour
        ),
        lump(2 * knob, 2 * knob, 2 * knob).moved(z=1.08 * z).part(dark),
        tube(np.array(spout), np.linspace(thick, 0.5 * thick, len(spout))).part(colour),
    ]
    if draw.chance(0.6):
        heights = (z * draw.even(0.2, 0.4), z * draw.even(0.7, 0.92))
        grip = handle(outside, heights, radius * draw.even(0.4, 0.8), radius * draw(0.07, 0.14), square=False)
        solids.append(grip.turned("z", math.pi).part(dark))
    else:
        up, wide = z * draw.even(1.3, 1.7), 0.75 * radius
        arch = smooth([(0.0, -wide, 0.85 * z), (0.0, -wide, up), (0.0, wide, up), (0.0, wide, 0.85 * z)])
        solids.append(tube(np.array(arch), radius * draw(0.06, 0.1)).part(dark))
    return solids


def pan(draw: RandomValues, colour: Colour) -> Parts:
    """Shallow, with one long handle."""
    radius, z = draw(0.08, 0.16), draw(0.03, 0.075)
    outside = smooth([(radius * draw.even(0.65, 0.9), 0.0), (0.95 * radius, 0.35 * z), (radius, z)])
    length, at = radius * draw.even(1.0, 1.9), z * draw.even(0.6, 0.95)
    rise, thick = length * draw.even(-0.02, 0.3), draw(0.007, 0.014)
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
        .scaled(y=draw.even(1.0, 1.8))
        .moved(z=at)
    )
    return [
        lathe(hollow(outside, draw(0.002, 0.004), min(0.004, 0.2 * z)), slices=28).part(colour),
        grip.part(draw.other(colour)),
    ]
