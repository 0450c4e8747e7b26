"""Clothes, accessories, toys and bathroom articles. Depth x, width y, height z [m]."""

from __future__ import annotations

import math
from itertools import pairwise

from semmap.nodes.sim_node.models.forms import (
    BLACK,
    BRASS,
    DARK,
    GLASSY,
    PAPER,
    STEEL,
    WHITE,
    column,
    ring,
    shade,
    shifted,
    slab,
    turned,
)
from semmap.nodes.sim_node.models.parts import (
    ALONG_X,
    ALONG_Y,
    Colour,
    Part,
    Parts,
    about,
    ball,
    box,
    collision,
    pill,
    product,
    rod,
    visual,
)


def keys(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A ring with two keys."""
    blades = [
        part
        for angle in (-0.35, 0.3)
        for part in (
            rod(0.2 * y, 0.8 * z, (0.02 * x * math.cos(angle), 0.2 * x * math.sin(angle), 0.4 * z), colour),
            box(
                (0.5 * x, 0.1 * y, 0.6 * z),
                (0.24 * x, 0.42 * x * math.sin(angle), 0.4 * z),
                colour,
                about("z", angle),
            ),
            box(
                (0.06 * x, 0.14 * y, 0.6 * z),
                (0.4 * x, 0.56 * x * math.sin(angle) + 0.07 * y, 0.4 * z),
                colour,
            ),
        )
    ]
    hoop = shifted(ring((0.22 * x, 0.22 * x), 0.4 * z, z, 0.03 * x, STEEL, count=12), x=-0.28 * x)
    return [*visual(blades), *visual(hoop), *collision(slab(0.95 * x, 0.8 * y, 0, z, colour))]


def glasses(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Two round lenses and folded-back temples."""
    radius = min(0.23 * y, z / 2)
    lenses = [
        part
        for s in (-1, 1)
        for part in (
            rod(radius, 0.05 * x, (0.45 * x, 0.26 * y * s, radius), colour, ALONG_X),
            rod(0.82 * radius, 0.06 * x, (0.455 * x, 0.26 * y * s, radius), GLASSY, ALONG_X),
            box((0.95 * x, 0.02 * y, 0.1 * z), (0, 0.48 * y * s, 1.4 * radius), colour),
            box(
                (0.12 * x, 0.02 * y, 0.5 * z),
                (-0.45 * x, 0.48 * y * s, 1.0 * radius),
                colour,
                about("y", 0.5),
            ),
        )
    ]
    bridge = box((0.05 * x, 0.14 * y, 0.1 * z), (0.45 * x, 0, 1.3 * radius), colour)
    return [*visual(lenses), *visual(bridge), *collision(slab(x, 0.9 * y, 0, 0.8 * z, colour))]


def wristwatch(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A dial on a strap laid out flat."""
    return [
        slab(x, 0.55 * y, 0, 0.5 * z, colour),
        *visual(rod(0.5 * y, 0.9 * z, (0, 0, 0.5 * z), BRASS)),
        *visual(rod(0.42 * y, 0.1 * z, (0, 0, 0.96 * z), PAPER)),
        *visual(box((0.3 * y, 0.04 * y, 0.05 * z), (0.13 * y, 0, z), BLACK)),
        *visual(box((0.04 * y, 0.22 * y, 0.05 * z), (0, 0.1 * y, z), BLACK)),
    ]


def wallet(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Folded leather with notes that peep out."""
    return [
        slab(x, y, 0, 0.42 * z, colour),
        *visual(slab(0.96 * x, 0.96 * y, 0.42 * z, 0.6 * z, PAPER)),
        slab(x, y, 0.58 * z, z, shade(colour, 1.2)),
        *visual(box((0.3 * x, 0.2 * y, 0.5 * z), (0.42 * x, 0, 0.6 * z), shade(colour, 0.7))),
        *visual(box((0.4 * x, 0.7 * y, 0.003), (-0.14 * x, 0, 0.52 * z), (0.5, 0.7, 0.5))),
    ]


def clothes(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A shirt laid flat: body, sleeves, a neckline at -x."""
    return [
        box((x, 0.56 * y, z), (0, 0, z / 2), colour),
        *visual(
            box((0.42 * x, 0.3 * y, 0.9 * z), (-0.3 * x, 0.33 * y * s, z / 2), colour, about("z", 0.5 * s))
            for s in (-1, 1)
        ),
        *visual(rod(0.11 * y, 0.004, (-0.48 * x, 0, z), shade(colour, 0.5))),
        *visual(rod(0.01, 0.003, (x * (-0.25 + 0.16 * i), 0, z), WHITE) for i in range(4)),
    ]


def hat(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A brim, a crown, a band."""
    radius = min(x, y) / 2
    return [
        column(radius, 0, 0.08 * z, colour),
        *turned([(0.6 * radius, 0.08 * z), (0.5 * radius, z)], colour, steps=5),
        *visual(column(0.62 * radius, 0.1 * z, 0.28 * z, DARK)),
        *collision(column(0.55 * radius, 0.08 * z, z, colour)),
    ]


def shoes(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A pair, toes to +x."""
    pair = [
        part
        for s in (-1, 1)
        for part in (
            box((0.96 * x, 0.36 * y, 0.18 * z), (0, 0.27 * y * s, 0.09 * z), WHITE),
            ball((0.6 * x, 0.38 * y, 0.7 * z), (0.18 * x, 0.27 * y * s, 0.36 * z), colour),
            ball((0.5 * x, 0.38 * y, 0.94 * z), (-0.22 * x, 0.27 * y * s, 0.48 * z), colour),
            rod(0.13 * y, 0.3 * z, (-0.24 * x, 0.27 * y * s, 0.86 * z), shade(colour, 0.5)),
        )
    ]
    return [
        *visual(pair),
        *collision(box((0.96 * x, 0.36 * y, 0.8 * z), (0, 0.27 * y * s, 0.4 * z), colour) for s in (-1, 1)),
    ]


def umbrella(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Folded and lying down: a pleated cone to a tip at +x, a strap, and a crook to hold it by."""
    middle, wood = z / 2, (0.42, 0.26, 0.13)
    pleats = [
        rod(
            middle * (1.0 - 0.115 * i),
            0.1 * x,
            ((0.1 * i - 0.16) * x, 0, middle),
            shade(colour, 0.8 + 0.3 * (i % 2)),
            ALONG_X,
        )
        for i in range(6)
    ]
    crook = [(-0.40 * x, 0.0), (-0.47 * x, 0.02 * y), (-0.49 * x, 0.25 * y), (-0.45 * x, 0.44 * y)]
    return [
        *visual(pleats),
        *visual(rod(1.06 * middle, 0.02 * x, (-0.1 * x, 0, middle), DARK, ALONG_X)),
        *visual(rod(0.008, 0.12 * x, (0.44 * x, 0, middle), STEEL, ALONG_X)),
        *visual(rod(0.008, 0.22 * x, (-0.31 * x, 0, middle), STEEL, ALONG_X)),
        *visual(_segment(start, end, middle, wood) for start, end in pairwise(crook)),
        *collision(box((0.9 * x, 0.6 * z, z), (0, 0, middle), colour)),
    ]


def _segment(start: tuple[float, float], end: tuple[float, float], z: float, colour: Colour) -> Part:
    """A piece of a bent rod at one height."""
    across, along = end[1] - start[1], end[0] - start[0]
    length = math.hypot(along, across)
    middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2, z)
    return pill(
        0.014, length + 0.028, middle, colour, product(about("z", math.atan2(across, along)), ALONG_X)
    )


def sphere(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A football with dark spots."""
    spots = [
        (1, 0, 0),
        (-1, 0, 0),
        (0, 1, 0),
        (0, -1, 0),
        (0, 0, 1),
        (0.6, 0.6, 0.53),
        (-0.6, 0.6, 0.53),
        (0.6, -0.6, 0.53),
        (-0.6, -0.6, 0.53),
    ]
    return [
        ball((x, y, z), (0, 0, z / 2), colour),
        *visual(
            ball((0.3 * x, 0.3 * y, 0.3 * z), (0.38 * x * i, 0.38 * y * j, z / 2 + 0.38 * z * k), BLACK)
            for i, j, k in spots
        ),
    ]


def soap(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A rounded bar."""
    return [
        *visual(ball((1.15 * x, 1.15 * y, 1.1 * z), (0, 0, 0.5 * z), colour)),
        *collision(slab(x, y, 0, z, colour)),
        *visual(box((0.5 * x, 0.6 * y, 0.01 * z), (0, 0, 1.04 * z), shade(colour, 0.85))),
    ]


def toothbrush(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A handle with bristles at the end."""
    return [
        slab(x, 0.8 * y, 0, 0.4 * z, colour),
        *visual(box((0.16 * x, y, 0.6 * z), (0.4 * x, 0, 0.7 * z), WHITE)),
        *visual(box((0.06 * x, y, 0.61 * z), (0.4 * x, 0, 0.7 * z), (0.3, 0.6, 0.9))),
    ]


def towel(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Terry, folded twice: its round folds at the front, stripes across."""
    radius, folds = 0.245 * z, []
    for i in range(2):
        width, tint, middle = (1 - 0.015 * i) * y, shade(colour, 1 - 0.12 * i), radius * (2 * i + 1)
        folds.append(box((x - radius, width, 2 * radius), (-radius / 2, 0, middle), tint))
        folds.append(rod(radius, width, (x / 2 - radius, 0, middle), tint, ALONG_Y))
    stripes = [
        box((0.05 * x, 0.986 * y, 0.004), (at * x, 0, z - 0.002), PAPER) for at in (-0.28, -0.18, 0.12)
    ]
    return [*visual([*folds, *stripes]), *collision(slab(x, y, 0, 0.96 * z, colour))]


def toilet_roll(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A standing roll with a dark core."""
    radius = min(x, y) / 2
    return [
        column(radius, 0, z, colour),
        *visual(column(0.4 * radius, 0.5 * z, z + 0.001, (0.55, 0.45, 0.35))),
    ]
