"""Boxes, bags and buckets. Depth x, width y, height z [m]."""

from __future__ import annotations

import math
from itertools import pairwise

from semmap.nodes.sim_node.models.forms import (
    BLACK,
    BRASS,
    DARK,
    PAPER,
    STEEL,
    column,
    hollow_box,
    ring,
    shade,
    slab,
)
from semmap.nodes.sim_node.models.openings import GAP_M, SIDES, cabinet_box, side_door
from semmap.nodes.sim_node.models.parts import (
    ALONG_Y,
    Colour,
    Joint,
    Parts,
    about,
    ball,
    box,
    moving,
    pill,
    rod,
    visual,
    with_cavity,
)


def crate(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A cardboard box, closed, with tape across the lid."""
    return [
        slab(x, y, 0, z, colour),
        *visual(slab(0.14 * x, y + 0.001, 0.85 * z, z + 0.001, (0.85, 0.78, 0.60))),
        *visual(box((x + 0.001, 0.25 * y, 0.16 * z), (0, 0.2 * y, 0.35 * z), PAPER)),
    ]


def cardboard_box(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A cardboard box with two flaps, taped where they meet."""
    wall = min(0.02 * max(x, y, 0.3), 0.1 * min(x, y, z))
    flaps: Parts = []
    for side, name in SIDES:
        board = box(
            (x, y / 2 - GAP_M, wall), (0, side * (y / 4 + GAP_M / 2), z - wall / 2), shade(colour, 1.08)
        )
        tape = box((x, 0.06 * y, 0.001), (0, side * (0.03 * y + GAP_M), z - 0.0004), (0.85, 0.78, 0.60))
        joint = Joint(
            name=name,
            kind="hinge",
            anchor=(0.0, side * y / 2, z - wall / 2),
            axis=(-float(side), 0.0, 0.0),
            range=(0.0, math.radians(210.0)),
            friction=0.02,
        )
        flaps += moving(joint, [board, *visual(tape)])
    return [
        *hollow_box(x, y, z - wall - GAP_M, wall, colour),
        *visual(box((0.001, 0.25 * y, 0.16 * z), (x / 2, 0.2 * y, 0.35 * z), PAPER)),
        *flaps,
    ]


def bag(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A shopping bag with two handles."""
    body = 0.74 * z
    return [
        with_cavity(slab(x, y, 0, body, colour), is_open=True),
        *visual(slab(0.86 * x, 0.94 * y, body, body + 0.004, shade(colour, 0.5))),
        *visual(
            part
            for s in (-1, 1)
            for part in (
                box((0.012, 0.025, z - body), (0.4 * x * s, -0.18 * y, (z + body) / 2), DARK),
                box((0.012, 0.025, z - body), (0.4 * x * s, 0.18 * y, (z + body) / 2), DARK),
                box((0.012, 0.39 * y, 0.025), (0.4 * x * s, 0, z - 0.0125), DARK),
            )
        ),
    ]


def backpack(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A rounded sack with a pocket in front and straps behind."""
    return [
        with_cavity(box((0.55 * x, 0.96 * y, 0.82 * z), (-0.05 * x, 0, 0.41 * z), colour), is_open=False),
        *visual(ball((0.55 * x, 0.96 * y, 0.4 * z), (-0.05 * x, 0, 0.8 * z), colour)),
        *visual(box((0.24 * x, 0.72 * y, 0.36 * z), (0.34 * x, 0, 0.25 * z), shade(colour, 0.75))),
        *visual(box((0.01, 0.6 * y, 0.012), (0.23 * x, 0, 0.62 * z), BRASS)),
        *visual(
            pill(0.06 * x, 0.7 * z, (-0.42 * x, 0.28 * y * s, 0.45 * z), shade(colour, 0.5)) for s in (-1, 1)
        ),
    ]


def suitcase(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Upright, ribbed, on wheels, with a pulled-out handle; its front half opens like a door."""
    low, high = 0.05 * z, 0.78 * z
    middle, tall = (low + high) / 2, high - low
    ribs = {
        side: visual(
            box((0.07 * x, 0.06 * y, 0.92 * tall), (side * 0.465 * x, y * k, middle), shade(colour, 1.25))
            for k in (-0.3, -0.1, 0.1, 0.3)
        )
        for side in (-1, 1)
    }
    shell = cabinet_box((0.65 * x, y, tall), (-0.125 * x, 0, middle), colour)
    wall = 0.03 * x
    rims = [
        *(
            box((0.22 * x, y, wall), (0.31 * x, 0, height), colour)
            for height in (low + wall / 2, high - wall / 2)
        ),
        *(
            box((0.22 * x, wall, tall - 2 * wall), (0.31 * x, side * (y - wall) / 2, middle), colour)
            for side in (-1, 1)
        ),
    ]
    lid = side_door(
        "lid", (wall, y, tall), (0.435 * x, 0, middle), colour, handle=[*rims, *ribs[1]], friction=0.1
    )
    return [
        *shell,
        *ribs[-1],
        *lid,
        *(
            rod(0.025 * z, 0.04, (0.36 * x * i, 0.4 * y * j, 0.025 * z), BLACK, ALONG_Y)
            for i in (-1, 1)
            for j in (-1, 1)
        ),
        *visual(rod(0.01, z - high, (-0.3 * x, 0.2 * y * s, (z + high) / 2), STEEL) for s in (-1, 1)),
        *visual(box((0.03, 0.46 * y, 0.025), (-0.3 * x, 0, z - 0.0125), BLACK)),
    ]


def case(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A briefcase, upright, with a grip and two locks."""
    body = 0.84 * z
    return [
        with_cavity(slab(x, y, 0, body, colour), is_open=False),
        *visual(box((1.02 * x, 1.002 * y, 0.02), (0, 0, 0.6 * body), shade(colour, 0.6))),
        *visual(box((0.01, 0.05 * y, 0.06 * z), (x / 2, 0.3 * y * s, 0.62 * body), BRASS) for s in (-1, 1)),
        *visual(box((0.25 * x, 0.03, z - body), (0, 0.15 * y * s, (z + body) / 2), DARK) for s in (-1, 1)),
        *visual(box((0.3 * x, 0.36 * y, 0.03), (0, 0, z - 0.015), DARK)),
    ]


def bin_(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A round waste bin; its lid is hinged behind, and has a grip in front."""
    radius, rim, lid = min(x, y) / 2, 0.92 * z, 0.96 * z
    joint = Joint(
        name="lid",
        kind="hinge",
        anchor=(-0.95 * radius, 0.0, rim),
        axis=(0.0, -1.0, 0.0),
        range=(0.0, math.radians(105.0)),
        friction=0.05,
    )
    cover = [
        column(0.97 * radius, rim + GAP_M, lid, shade(colour, 1.2)),
        box((0.18 * radius, 0.5 * radius, z - lid), (0.7 * radius, 0, (lid + z) / 2), shade(colour, 0.5)),
    ]
    return [
        column(0.78 * radius, 0, 0.03 * z, colour),
        *ring((0.8 * radius, 0.98 * radius), 0.01 * z, rim, 0.006, colour),
        *visual(ring((radius, radius), 0.88 * z, rim, 0.012, shade(colour, 0.7))),
        *moving(joint, cover),
    ]


def bucket(x: float, y: float, z: float, colour: Colour) -> Parts:
    """An open pail with its bail up."""
    radius, rim = min(x, y) / 2, 0.68 * z
    rise = z - rim - 0.004
    corners = [
        (0.95 * radius * math.cos(a), rim + rise * math.sin(a)) for a in (math.pi * i / 8 for i in range(9))
    ]
    bail = visual(
        box(
            (0.008, 0.008, math.hypot(y1 - y0, z1 - z0) + 0.004),
            (0, (y0 + y1) / 2, (z0 + z1) / 2),
            STEEL,
            about("x", -math.atan2(y1 - y0, z1 - z0)),
        )
        for (y0, z0), (y1, z1) in pairwise(corners)
    )
    return [
        column(0.7 * radius, 0, 0.03 * z, colour),
        *ring((0.72 * radius, 0.98 * radius), 0.01 * z, rim, 0.006, colour),
        *visual(ring((radius, radius), 0.93 * rim, rim, 0.01, shade(colour, 0.8))),
        *bail,
    ]


def basket(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A woven, open box with two grips."""
    bands = 4
    hollow = hollow_box(x, y, z, 0.012, colour)
    outer = [
        part
        for band in range(bands)
        for part in visual(
            box((size_x, size_y, 0.3 * z / bands), (px, py, z * (band + 0.5) / bands), shade(colour, 0.72))
            for size_x, size_y, px, py in (
                (0.004, y, x / 2, 0.0),
                (0.004, y, -x / 2, 0.0),
                (x, 0.004, 0.0, y / 2),
                (x, 0.004, 0.0, -y / 2),
            )
        )
    ]
    grips = visual(box((0.3 * x, 0.02, 0.06 * z), (0, (y / 2 + 0.004) * s, 0.88 * z), DARK) for s in (-1, 1))
    return [*hollow, *outer, *grips]
