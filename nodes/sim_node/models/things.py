"""Everything else that lies, hangs or stands about in a home. Depth x, width y, height z [m]."""

from __future__ import annotations

import math
from itertools import pairwise

from nodes.sim_node.models.forms import (
    BLACK,
    BRASS,
    DARK,
    GLASSY,
    GREY,
    PAPER,
    STEEL,
    WHITE,
    WOOD,
    column,
    hollow_box,
    ring,
    shade,
    shifted,
    slab,
    turned,
)
from nodes.sim_node.models.parts import (
    ALONG_X,
    ALONG_Y,
    Colour,
    Part,
    Parts,
    about,
    ball,
    box,
    felt,
    pill,
    product,
    rod,
    seen,
)

LEAF: Colour = (0.25, 0.50, 0.20)


def crate(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A cardboard box, closed, with tape across the lid."""
    return [
        slab(x, y, 0, z, colour),
        *seen(slab(0.14 * x, y + 0.001, 0.85 * z, z + 0.001, (0.85, 0.78, 0.60))),
        *seen(box((x + 0.001, 0.25 * y, 0.16 * z), (0, 0.2 * y, 0.35 * z), PAPER)),
    ]


def book(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Lying: two boards, white leaves, the spine at -y."""
    board = min(0.003, 0.15 * z)
    return [
        *seen(slab(x, y, 0, board, colour)),
        *seen(slab(x, y, z - board, z, colour)),
        *seen(box((0.96 * x, 0.96 * y, z - 2 * board), (0, 0, z / 2), PAPER)),
        *seen(box((x, 0.06 * y, z), (0, -0.47 * y, z / 2), colour)),
        *seen(box((0.5 * x, 0.5 * y, 0.001), (0.1 * x, 0.02 * y, z), BRASS)),
        *felt(slab(x, y, 0, z, colour)),
    ]


def magazine(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A glossy cover with a title bar."""
    return [
        slab(x, y, 0, z, colour),
        *seen(box((0.2 * x, 0.9 * y, 0.001), (-0.36 * x, 0, z), WHITE)),
        *seen(rod(0.22 * y, 0.001, (0.12 * x, 0, z), (0.95, 0.75, 0.55))),
    ]


def newspaper(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A folded sheet with a headline and columns."""
    lines = seen(
        box((0.02 * x, 0.4 * y, 0.001), (x * (-0.15 + 0.09 * i), 0.24 * y * s, z), GREY)
        for i in range(7)
        for s in (-1, 1)
    )
    return [
        slab(x, y, 0, z, colour),
        *seen(box((0.09 * x, 0.85 * y, 0.001), (-0.36 * x, 0, z), BLACK)),
        *lines,
    ]


def paper(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A sheet with lines of writing."""
    lines = seen(
        box((0.012 * x, 0.75 * y, 0.0006), (x * (-0.38 + 0.1 * i), 0, z), (0.3, 0.35, 0.5)) for i in range(8)
    )
    return [slab(x, y, 0, z, colour), *lines]


def envelope(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A cover with its flap and a stamp."""
    flap = seen(
        box((0.006, 0.55 * y, 0.001), (-0.18 * x, 0.23 * y * s, z), shade(colour, 0.75), about("z", 0.5 * s))
        for s in (-1, 1)
    )
    return [
        slab(x, y, 0, z, colour),
        *flap,
        *seen(box((0.2 * x, 0.13 * y, 0.001), (-0.34 * x, 0.4 * y, z), (0.8, 0.2, 0.2))),
    ]


def postcard(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A beach: sky, sea, sand."""
    return [
        slab(x, y, 0, z, WHITE),
        *seen(box((0.3 * x, 0.94 * y, 0.001), (-0.3 * x, 0, z), (0.55, 0.80, 0.95))),
        *seen(box((0.26 * x, 0.94 * y, 0.001), (-0.02 * x, 0, z), colour)),
        *seen(box((0.32 * x, 0.94 * y, 0.001), (0.27 * x, 0, z), (0.93, 0.85, 0.60))),
    ]


def folder(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A ring binder, standing, its labelled back to +x."""
    return [
        slab(x, y, 0, z, colour),
        *seen(box((0.002, 0.7 * y, 0.4 * z), (x / 2, 0, 0.62 * z), PAPER)),
        *seen(rod(0.25 * y, 0.003, (x / 2, 0, 0.2 * z), BLACK, ALONG_X)),
    ]


def pen(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A barrel, a cap, a tip."""
    radius = min(y, z) / 2
    return [
        *seen(rod(radius, 0.6 * x, (0.05 * x, 0, radius), colour, ALONG_X)),
        *seen(rod(1.0 * radius, 0.35 * x, (-0.325 * x, 0, radius), DARK, ALONG_X)),
        *seen(rod(0.5 * radius, 0.15 * x, (0.42 * x, 0, radius), BRASS, ALONG_X)),
        *felt(slab(x, y, 0, 2 * radius, colour)),
    ]


def scissors(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Two crossed blades, two rings."""
    blades = seen(
        box((0.62 * x, 0.14 * y, 0.5 * z), (0.18 * x, 0, z / 2), STEEL, about("z", 0.14 * s)) for s in (-1, 1)
    )
    rings = [
        part
        for s in (-1, 1)
        for part in shifted(
            ring((0.27 * y, 0.27 * y), 0.0, z, 0.06 * y, colour, count=8), x=-0.36 * x, y=0.23 * y * s
        )
    ]
    return [*blades, *seen(rings), *felt(slab(0.95 * x, 0.7 * y, 0, z, colour))]


def screwdriver(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A fat grip and a shaft towards +x."""
    radius = min(y, z) / 2
    return [
        rod(radius, 0.42 * x, (-0.29 * x, 0, radius), colour, ALONG_X),
        *seen(rod(0.25 * radius, 0.56 * x, (0.2 * x, 0, radius), STEEL, ALONG_X)),
        *seen(box((0.04 * x, 0.7 * radius, 0.2 * radius), (0.48 * x, 0, radius), STEEL)),
        *felt(slab(x, 1.4 * radius, 0, 0.3 * radius, colour)),
    ]


def wrench(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A shank with an open jaw at one end and a ring at the other."""
    jaws = seen(
        box((0.16 * x, 0.26 * y, z), (0.42 * x, 0.33 * y * s, z / 2), colour, about("z", 0.25 * s))
        for s in (-1, 1)
    )
    return [
        *seen(box((0.7 * x, 0.34 * y, 0.7 * z), (-0.05 * x, 0, z / 2), colour)),
        *seen(rod(0.42 * y, z, (0.27 * x, 0, z / 2), colour)),
        *jaws,
        *seen(shifted(ring((0.45 * y, 0.45 * y), 0, z, 0.2 * y, colour, count=10), x=-0.5 * x + 0.45 * y)),
        *felt(slab(x, 0.9 * y, 0, z, colour)),
    ]


def hammer(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A steel head across the end of a wooden haft."""
    return [
        box((0.82 * x, 0.22 * y, 0.7 * z), (-0.09 * x, 0, 0.5 * z), colour),
        *seen(box((0.12 * x, 0.7 * y, 0.9 * z), (0.42 * x, 0.05 * y, 0.5 * z), STEEL)),
        *seen(rod(0.5 * z, 0.15 * y, (0.42 * x, 0.425 * y, 0.5 * z), STEEL, ALONG_Y)),
        *seen(box((0.09 * x, 0.3 * y, 0.5 * z), (0.42 * x, -0.4 * y, 0.5 * z), STEEL, about("z", 0.3))),
        *felt(box((0.14 * x, y, z), (0.42 * x, 0, z / 2), STEEL)),
    ]


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
    return [*seen(blades), *seen(hoop), *felt(slab(0.95 * x, 0.8 * y, 0, z, colour))]


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
    return [*seen(lenses), *seen(bridge), *felt(slab(x, 0.9 * y, 0, 0.8 * z, colour))]


def wristwatch(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A dial on a strap laid out flat."""
    return [
        slab(x, 0.55 * y, 0, 0.5 * z, colour),
        *seen(rod(0.5 * y, 0.9 * z, (0, 0, 0.5 * z), BRASS)),
        *seen(rod(0.42 * y, 0.1 * z, (0, 0, 0.96 * z), PAPER)),
        *seen(box((0.3 * y, 0.04 * y, 0.05 * z), (0.13 * y, 0, z), BLACK)),
        *seen(box((0.04 * y, 0.22 * y, 0.05 * z), (0, 0.1 * y, z), BLACK)),
    ]


def wallet(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Folded leather with notes that peep out."""
    return [
        slab(x, y, 0, 0.42 * z, colour),
        *seen(slab(0.96 * x, 0.96 * y, 0.42 * z, 0.6 * z, PAPER)),
        slab(x, y, 0.58 * z, z, shade(colour, 1.2)),
        *seen(box((0.3 * x, 0.2 * y, 0.5 * z), (0.42 * x, 0, 0.6 * z), shade(colour, 0.7))),
        *seen(box((0.4 * x, 0.7 * y, 0.003), (-0.14 * x, 0, 0.52 * z), (0.5, 0.7, 0.5))),
    ]


def soap(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A rounded bar."""
    return [
        *seen(ball((1.15 * x, 1.15 * y, 1.1 * z), (0, 0, 0.5 * z), colour)),
        *felt(slab(x, y, 0, z, colour)),
        *seen(box((0.5 * x, 0.6 * y, 0.01 * z), (0, 0, 1.04 * z), shade(colour, 0.85))),
    ]


def toothbrush(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A handle with bristles at the end."""
    return [
        slab(x, 0.8 * y, 0, 0.4 * z, colour),
        *seen(box((0.16 * x, y, 0.6 * z), (0.4 * x, 0, 0.7 * z), WHITE)),
        *seen(box((0.06 * x, y, 0.61 * z), (0.4 * x, 0, 0.7 * z), (0.3, 0.6, 0.9))),
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
    return [*seen([*folds, *stripes]), *felt(slab(x, y, 0, 0.96 * z, colour))]


def clothes(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A shirt laid flat: body, sleeves, a neckline at -x."""
    return [
        box((x, 0.56 * y, z), (0, 0, z / 2), colour),
        *seen(
            box((0.42 * x, 0.3 * y, 0.9 * z), (-0.3 * x, 0.33 * y * s, z / 2), colour, about("z", 0.5 * s))
            for s in (-1, 1)
        ),
        *seen(rod(0.11 * y, 0.004, (-0.48 * x, 0, z), shade(colour, 0.5))),
        *seen(rod(0.01, 0.003, (x * (-0.25 + 0.16 * i), 0, z), WHITE) for i in range(4)),
    ]


def hat(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A brim, a crown, a band."""
    radius = min(x, y) / 2
    return [
        column(radius, 0, 0.08 * z, colour),
        *turned([(0.6 * radius, 0.08 * z), (0.5 * radius, z)], colour, steps=5),
        *seen(column(0.62 * radius, 0.1 * z, 0.28 * z, DARK)),
        *felt(column(0.55 * radius, 0.08 * z, z, colour)),
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
        *seen(pair),
        *felt(box((0.96 * x, 0.36 * y, 0.8 * z), (0, 0.27 * y * s, 0.4 * z), colour) for s in (-1, 1)),
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
        *seen(pleats),
        *seen(rod(1.06 * middle, 0.02 * x, (-0.1 * x, 0, middle), DARK, ALONG_X)),
        *seen(rod(0.008, 0.12 * x, (0.44 * x, 0, middle), STEEL, ALONG_X)),
        *seen(rod(0.008, 0.22 * x, (-0.31 * x, 0, middle), STEEL, ALONG_X)),
        *seen(_segment(start, end, middle, wood) for start, end in pairwise(crook)),
        *felt(box((0.9 * x, 0.6 * z, z), (0, 0, middle), colour)),
    ]


def _segment(start: tuple[float, float], end: tuple[float, float], z: float, colour: Colour) -> Part:
    """A piece of a bent rod at one height."""
    across, along = end[1] - start[1], end[0] - start[0]
    length = math.hypot(along, across)
    middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2, z)
    return pill(
        0.014, length + 0.028, middle, colour, product(about("z", math.atan2(across, along)), ALONG_X)
    )


def bag(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A shopping bag with two handles."""
    body = 0.74 * z
    return [
        slab(x, y, 0, body, colour),
        *seen(slab(0.86 * x, 0.94 * y, body, body + 0.004, shade(colour, 0.5))),
        *seen(
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
        box((0.55 * x, 0.96 * y, 0.82 * z), (-0.05 * x, 0, 0.41 * z), colour),
        *seen(ball((0.55 * x, 0.96 * y, 0.4 * z), (-0.05 * x, 0, 0.8 * z), colour)),
        *seen(box((0.24 * x, 0.72 * y, 0.36 * z), (0.34 * x, 0, 0.25 * z), shade(colour, 0.75))),
        *seen(box((0.01, 0.6 * y, 0.012), (0.23 * x, 0, 0.62 * z), BRASS)),
        *seen(
            pill(0.06 * x, 0.7 * z, (-0.42 * x, 0.28 * y * s, 0.45 * z), shade(colour, 0.5)) for s in (-1, 1)
        ),
    ]


def suitcase(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Upright, ribbed, on wheels, with a pulled-out handle."""
    low, high = 0.05 * z, 0.78 * z
    return [
        slab(0.9 * x, y, low, high, colour),
        *seen(
            box((x, 0.06 * y, 0.92 * (high - low)), (0, y * k, (low + high) / 2), shade(colour, 1.25))
            for k in (-0.3, -0.1, 0.1, 0.3)
        ),
        *(
            rod(0.025 * z, 0.04, (0.36 * x * i, 0.4 * y * j, 0.025 * z), BLACK, ALONG_Y)
            for i in (-1, 1)
            for j in (-1, 1)
        ),
        *seen(rod(0.01, z - high, (-0.3 * x, 0.2 * y * s, (z + high) / 2), STEEL) for s in (-1, 1)),
        *seen(box((0.03, 0.46 * y, 0.025), (-0.3 * x, 0, z - 0.0125), BLACK)),
    ]


def case(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A briefcase, upright, with a grip and two locks."""
    body = 0.84 * z
    return [
        slab(x, y, 0, body, colour),
        *seen(box((1.02 * x, 1.002 * y, 0.02), (0, 0, 0.6 * body), shade(colour, 0.6))),
        *seen(box((0.01, 0.05 * y, 0.06 * z), (x / 2, 0.3 * y * s, 0.62 * body), BRASS) for s in (-1, 1)),
        *seen(box((0.25 * x, 0.03, z - body), (0, 0.15 * y * s, (z + body) / 2), DARK) for s in (-1, 1)),
        *seen(box((0.3 * x, 0.36 * y, 0.03), (0, 0, z - 0.015), DARK)),
    ]


def bin_(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A round, open waste bin."""
    radius = min(x, y) / 2
    return [
        column(0.78 * radius, 0, 0.03 * z, colour),
        *ring((0.8 * radius, 0.98 * radius), 0.01 * z, z, 0.006, colour),
        *seen(ring((radius, radius), 0.94 * z, z, 0.012, shade(colour, 0.7))),
    ]


def bucket(x: float, y: float, z: float, colour: Colour) -> Parts:
    """An open pail with its bail up."""
    radius, rim = min(x, y) / 2, 0.68 * z
    rise = z - rim - 0.004
    corners = [
        (0.95 * radius * math.cos(a), rim + rise * math.sin(a)) for a in (math.pi * i / 8 for i in range(9))
    ]
    bail = seen(
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
        *seen(ring((radius, radius), 0.93 * rim, rim, 0.01, shade(colour, 0.8))),
        *bail,
    ]


def basket(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A woven, open box with two grips."""
    bands = 4
    hollow = hollow_box(x, y, z, 0.012, colour)
    outer = [
        part
        for band in range(bands)
        for part in seen(
            box((size_x, size_y, 0.3 * z / bands), (px, py, z * (band + 0.5) / bands), shade(colour, 0.72))
            for size_x, size_y, px, py in (
                (0.004, y, x / 2, 0.0),
                (0.004, y, -x / 2, 0.0),
                (x, 0.004, 0.0, y / 2),
                (x, 0.004, 0.0, -y / 2),
            )
        )
    ]
    grips = seen(box((0.3 * x, 0.02, 0.06 * z), (0, (y / 2 + 0.004) * s, 0.88 * z), DARK) for s in (-1, 1))
    return [*hollow, *outer, *grips]


def broom(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Bristles below, a long stick."""
    head = 0.1 * z
    return [
        slab(x, y, 0, head, (0.80, 0.65, 0.35)),
        slab(0.8 * x, 0.9 * y, head, 1.3 * head, colour),
        column(0.013, 1.3 * head, z, WOOD),
    ]


def candle(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Wax on a saucer, wick and flame."""
    radius = min(x, y) / 2
    return [
        column(radius, 0, 0.06 * z, BRASS),
        column(0.5 * radius, 0.06 * z, 0.8 * z, colour),
        *seen(column(0.05 * radius, 0.8 * z, 0.86 * z, BLACK)),
        *seen(ball((0.28 * radius, 0.28 * radius, 0.16 * z), (0, 0, 0.92 * z), (1.0, 0.75, 0.2))),
    ]


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
        *seen(
            ball((0.3 * x, 0.3 * y, 0.3 * z), (0.38 * x * i, 0.38 * y * j, z / 2 + 0.38 * z * k), BLACK)
            for i, j, k in spots
        ),
    ]


def flower_pot(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A clay pot with a rim and earth."""
    radius = min(x, y) / 2
    return [
        *turned([(0.68 * radius, 0), (0.92 * radius, 0.8 * z)], colour, steps=6),
        *felt(column(0.72 * radius, 0, 0.8 * z, colour)),
        column(radius, 0.8 * z, z, shade(colour, 0.9)),
        *seen(column(0.88 * radius, z, z + 0.002, (0.25, 0.17, 0.1))),
    ]


def plant(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A pot with a bush of leaves."""
    radius = 0.3 * min(x, y)
    pot = flower_pot(2 * radius, 2 * radius, 0.3 * z, (0.72, 0.38, 0.24))
    leaves = seen(
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
        *seen(column(0.012, 0.3 * z, 0.85 * z, WOOD)),
        *seen(ball((0.12 * x, 0.12 * y, 0.3 * z), (0, 0, 0.85 * z), colour)),
        *felt(column(0.8 * radius, 0.3 * z, 0.9 * z, colour)),
    ]


def flower(x: float, y: float, z: float, colour: Colour) -> Parts:
    """One bloom on a stalk in a small pot."""
    pot = min(x, y) * 0.6
    bloom = 0.93 * z
    petals = seen(
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
        *seen(column(0.006, 0.28 * z, bloom, LEAF)),
        *petals,
        *seen(ball((0.22 * x, 0.22 * y, 0.08 * z), (0, 0, bloom + 0.02 * z), (0.95, 0.8, 0.25))),
        *seen(
            ball((0.3 * x, 0.1 * y, 0.03 * z), (0.12 * x * s, 0, 0.5 * z), LEAF, about("y", -0.5 * s))
            for s in (-1, 1)
        ),
        *felt(column(0.3 * pot, 0.28 * z, 0.9 * z, colour)),
    ]
