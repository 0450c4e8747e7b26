"""Tableware and kitchen vessels. Depth x, width y, height z [m]; round ones fit the smaller of x and y."""

from __future__ import annotations

from nodes.sim_node.models.forms import (
    DARK,
    STEEL,
    WHITE,
    column,
    ring,
    shade,
    slab,
    turned,
)
from nodes.sim_node.models.parts import (
    ALONG_Y,
    Colour,
    Parts,
    box,
    felt,
    pill,
    rod,
    seen,
)


def cup(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Hollow, with a handle towards +y."""
    radius = min(0.5 * x, 0.4 * y)
    shift = -(y / 2 - radius)
    wall = 0.1 * radius
    body = [
        column(0.8 * radius, 0, 2 * wall, shade(colour, 0.85)),
        *ring((0.85 * radius, radius), wall, z, wall, colour),
    ]
    grip = y / 2 - (shift + radius)
    handle = [
        pill(0.09 * radius, 0.55 * z, (0, shift + radius + 0.75 * grip * 2 - 0.09 * radius, 0.5 * z), colour),
        *(
            rod(0.09 * radius, 1.4 * grip, (0, shift + radius + 0.6 * grip, height * z), colour, ALONG_Y)
            for height in (0.28, 0.72)
        ),
    ]
    from dataclasses import replace

    return [
        *(replace(part, centre=(part.centre[0], part.centre[1] + shift, part.centre[2])) for part in body),
        *seen(handle),
    ]


def glass(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A plain tumbler, wider at the top."""
    radius = min(x, y) / 2
    wall = 0.08 * radius
    return [
        column(0.75 * radius, 0, 0.08 * z, shade(colour, 0.8)),
        *ring((0.78 * radius, radius), 0.04 * z, z, wall, colour),
    ]


def bowl(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A foot and two flaring rings."""
    radius = min(x, y) / 2
    wall = min(0.006, 0.1 * radius)
    return [
        column(0.5 * radius, 0, 0.15 * z, colour),
        *ring((0.48 * radius, 0.82 * radius), 0.04 * z, 0.5 * z, wall, shade(colour, 0.9)),
        *ring((0.8 * radius, radius), 0.45 * z, z, wall, colour),
    ]


def plate(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Flat, with a raised rim."""
    radius = min(x, y) / 2
    return [
        column(0.65 * radius, 0, 0.5 * z, shade(colour, 0.92)),
        *ring((0.65 * radius, radius), 0.1 * z, z, 0.004, colour, count=16),
    ]


def can(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A tin with a shining rim at both ends and a label."""
    radius = min(x, y) / 2
    return [
        column(radius, 0, z, STEEL),
        *seen(column(1.015 * radius, 0.1 * z, 0.9 * z, colour)),
        *seen(column(0.85 * radius, z, z + 0.001, shade(STEEL, 0.8))),
    ]


def bottle(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Body, sloping shoulder, neck and cap."""
    radius = min(x, y) / 2
    neck = 0.36 * radius
    return [
        column(radius, 0, 0.58 * z, colour),
        *seen(column(1.01 * radius, 0.16 * z, 0.46 * z, WHITE)),
        *turned([(radius, 0.58 * z), (neck, 0.78 * z), (neck, 0.94 * z)], colour, steps=8),
        *seen(column(1.25 * neck, 0.92 * z, z, shade(colour, 0.5))),
        *felt(column(0.6 * radius, 0.58 * z, 0.75 * z, colour)),
        *felt(column(neck, 0.75 * z, z, colour)),
    ]


def jar(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A stout glass with a screw lid."""
    radius = min(x, y) / 2
    return [
        column(radius, 0, 0.78 * z, colour),
        *turned([(radius, 0.78 * z), (0.82 * radius, 0.84 * z)], colour, steps=3),
        column(0.88 * radius, 0.82 * z, z, (0.75, 0.2, 0.15)),
        *seen(column(1.01 * radius, 0.2 * z, 0.6 * z, WHITE)),
    ]


def tray(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Flat with a low rim and two grips."""
    wall = min(0.015, x / 10)
    floor = 0.25 * z
    return [
        slab(x, y, 0, floor, colour),
        *(
            box((x, wall, z - floor), (0, s * (y - wall) / 2, (z + floor) / 2), shade(colour, 0.8))
            for s in (-1, 1)
        ),
        *(
            box((wall, y, z - floor), (s * (x - wall) / 2, 0, (z + floor) / 2), shade(colour, 0.8))
            for s in (-1, 1)
        ),
        *seen(box((0.3 * x, 1.01 * wall, 0.4 * z), (0, s * (y - wall) / 2, 0.75 * z), DARK) for s in (-1, 1)),
    ]
