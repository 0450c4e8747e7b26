"""Food. Depth x, width y, height z [m]."""

from __future__ import annotations

import math

from semmap.nodes.sim_node.models.forms import (
    WHITE,
    column,
    shade,
    slab,
    turned,
)
from semmap.nodes.sim_node.models.parts import (
    ALONG_X,
    ALONG_Y,
    Colour,
    Parts,
    about,
    ball,
    box,
    collision,
    rod,
    visual,
    with_cavity,
)

GREEN: Colour = (0.30, 0.55, 0.20)


def _stalk(height: float, length: float, colour: Colour = (0.35, 0.25, 0.15)) -> Parts:
    return visual(rod(0.0025, length, (0, 0, height), colour))


def apple(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Round and dented, with a stalk and a leaf."""
    body = 0.88 * z
    return [
        ball((x, y, body), (0, 0, body / 2), colour),
        *_stalk(0.93 * z, 0.14 * z),
        *visual(ball((0.3 * x, 0.14 * y, 0.04 * z), (0.14 * x, 0, 0.95 * z), GREEN, about("y", -0.3))),
    ]


def round_fruit(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A plain ball with a navel: an orange, an onion, an egg."""
    return [
        ball((x, y, z), (0, 0, z / 2), colour),
        *visual(rod(0.06 * x, 0.01 * z, (0, 0, 0.995 * z), GREEN)),
    ]


def egg(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Lying on its side, one end slimmer."""
    return [
        ball((x, 0.9 * y, z), (0, -0.05 * y, z / 2), colour),
        *visual(ball((0.82 * x, 0.8 * y, 0.82 * z), (0, 0.1 * y, z / 2), colour)),
    ]


def lemon(x: float, y: float, z: float, colour: Colour) -> Parts:
    """An ellipsoid with a nipple at each end."""
    return [
        ball((x, 0.9 * y, z), (0, 0, z / 2), colour),
        *visual(ball((0.3 * x, 0.2 * y, 0.3 * z), (0, 0.41 * y * s, z / 2), colour) for s in (-1, 1)),
    ]


def pear(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A wide bottom, a slim top, a stalk."""
    return [
        ball((x, y, 0.66 * z), (0, 0, 0.33 * z), colour),
        *visual(ball((0.62 * x, 0.62 * y, 0.6 * z), (0, 0, 0.63 * z), colour)),
        *_stalk(0.95 * z, 0.1 * z),
    ]


def tomato(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Flat and round with a green star."""
    return [
        ball((x, y, 0.94 * z), (0, 0, 0.47 * z), colour),
        *visual(
            box((0.5 * x, 0.08 * y, 0.03 * z), (0, 0, 0.94 * z), GREEN, about("z", i * math.pi / 3))
            for i in range(3)
        ),
        *_stalk(0.96 * z, 0.08 * z, GREEN),
    ]


def onion(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A bulb that runs out in a tip."""
    return [
        ball((x, y, 0.8 * z), (0, 0, 0.4 * z), colour),
        *turned([(0.3 * x, 0.72 * z), (0.05 * x, z)], shade(colour, 0.85), steps=5),
    ]


def potato(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A lumpy oblong."""
    return [
        ball((x, 0.9 * y, z), (0, -0.05 * y, z / 2), colour),
        *visual(ball((0.8 * x, 0.5 * y, 0.85 * z), (0.05 * x, 0.25 * y, 0.47 * z), shade(colour, 0.95))),
        *visual(ball((0.12 * x, 0.06 * y, 0.1 * z), (0.2 * x, -0.1 * y, 0.93 * z), shade(colour, 0.6))),
    ]


def banana(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A curve of ellipsoids, dark at the ends."""
    radius, sagitta, half = z / 2, x - z, y / 2 - z / 4
    bend = (half * half + sagitta * sagitta) / (2.0 * sagitta)
    reach = math.asin(min(1.0, half / bend))
    count = 7
    flesh, tips = [], []
    for i in range(count + 1):
        angle = reach * (2.0 * i / count - 1.0)
        centre = (bend * (math.cos(angle) - 1.0) + sagitta / 2, bend * math.sin(angle), radius)
        if i in (0, count):
            tips.append(ball((0.45 * z, 0.45 * z, 0.45 * z), centre, (0.3, 0.22, 0.1)))
        else:
            thick = z * (1.0 - 0.25 * (angle / reach) ** 2)
            size = (thick, 3.2 * half / count, thick)
            flesh.append(ball(size, centre, colour, about("z", angle)))
    return [
        *visual(flesh),
        *visual(tips),
        *collision(box((0.7 * x, 0.8 * y, 0.9 * z), (0, 0, 0.45 * z), colour)),
    ]


def carrot(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A lying cone towards +y with leaves behind."""
    slices = 8
    length = 0.72 * y
    discs = visual(
        rod(
            z / 2 * (1 - 0.8 * i / slices),
            length / slices,
            (0, -0.22 * y + length * (i + 0.5) / slices, z / 2),
            colour,
            ALONG_Y,
        )
        for i in range(slices)
    )
    leaves = visual(
        ball((0.25 * x, 0.3 * y, 0.3 * z), (0.2 * x * k, -0.34 * y, 0.55 * z), GREEN, about("z", 0.25 * k))
        for k in (-1, 0, 1)
    )
    return [*discs, *leaves, *collision(slab(0.8 * x, 0.9 * y, 0, z, colour))]


def corn(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A cob with rows of grains in husks."""
    rows = visual(
        ball(
            (0.9 * x, 0.09 * y, 0.98 * z),
            (0, -0.1 * y + 0.075 * y * i, z / 2),
            shade(colour, 1 - 0.14 * (i % 2)),
        )
        for i in range(8)
    )
    husk = visual(
        ball((0.95 * x, 0.5 * y, 0.5 * z), (0, -0.25 * y, 0.3 * z + 0.4 * z * i), GREEN) for i in (0, 1)
    )
    return [*rows, *husk, *collision(slab(0.8 * x, 0.95 * y, 0, z, colour))]


def bread(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A long loaf with cuts across."""
    return [
        *visual(ball((x, y, z), (0, 0, 0.5 * z), colour)),
        *visual(
            box(
                (0.55 * x, 0.03 * y, 0.05 * z),
                (0, 0.17 * y * i, (0.985 - 0.05 * i * i) * z),
                (0.95, 0.85, 0.62),
                about("z", 0.5),
            )
            for i in (-2, -1, 0, 1, 2)
        ),
        *collision(slab(0.7 * x, 0.75 * y, 0, 0.9 * z, colour)),
    ]


def cheese(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A wedge with holes."""
    steps = 8
    slices = visual(
        box((x / steps, y * (1 - i / steps), z), (x * ((i + 0.5) / steps - 0.5), 0, z / 2), colour)
        for i in range(steps)
    )
    holes = visual(
        rod(r * x, 0.002, (x * px, y * py, z), shade(colour, 0.7))
        for r, px, py in ((0.07, -0.3, 0.15), (0.05, -0.1, -0.1), (0.06, 0.1, 0.02), (0.04, -0.35, -0.25))
    )
    return [*slices, *holes, *collision(box((0.8 * x, 0.6 * y, z), (-0.1 * x, 0, z / 2), colour))]


def cereal_box(x: float, y: float, z: float, colour: Colour) -> Parts:
    """An upright carton with a bowl printed on it."""
    return [
        slab(x, y, 0, z, colour),
        *visual(box((x + 0.002, 0.8 * y, 0.2 * z), (0, 0, 0.8 * z), WHITE)),
        *visual(rod(0.3 * y, x + 0.002, (0, 0, 0.36 * z), (0.95, 0.85, 0.55), ALONG_X)),
        *visual(rod(0.2 * y, x + 0.004, (0, 0, 0.4 * z), (0.80, 0.50, 0.20), ALONG_X)),
    ]


def carton(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A milk carton with a gable and a cap."""
    body = 0.76 * z
    roof = visual(
        box(
            (x * (1 - 0.9 * (i + 0.5) / 6), y, 0.17 * z / 6),
            (0, 0, body + 0.17 * z * (i + 0.5) / 6),
            shade(colour, 1.1),
        )
        for i in range(6)
    )
    return [
        with_cavity(slab(x, y, 0, body, colour), is_open=False),
        *roof,
        *visual(box((0.06 * x, y, 0.1 * z), (0, 0, 0.95 * z), WHITE)),
        *visual(box((x + 0.002, 0.75 * y, 0.3 * z), (0, 0, 0.4 * z), WHITE)),
        *visual(rod(0.16 * x, 0.04 * z, (0.28 * x, 0, 0.86 * z), (0.85, 0.2, 0.2), about("y", 0.8))),
        *collision(slab(0.4 * x, y, body, z, colour)),
    ]


def yogurt(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A small tub, wider at the top, with a foil lid."""
    radius = min(x, y) / 2
    return [
        *turned([(0.72 * radius, 0), (0.95 * radius, 0.95 * z)], colour, steps=6),
        *visual(column(radius, 0.95 * z, z, (0.85, 0.86, 0.90))),
        *visual(rod(0.88 * radius, 0.3 * z, (0, 0, 0.5 * z), (0.75, 0.25, 0.45))),
        *collision(column(0.8 * radius, 0, z, colour)),
    ]


def pills(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A small carton with a red cross."""
    return [
        slab(x, y, 0, z, colour),
        *visual(box((0.4 * x, 0.12 * y, 0.002), (0, 0, z), (0.8, 0.1, 0.1))),
        *visual(box((0.12 * x, 0.4 * y, 0.002), (0, 0, z), (0.8, 0.1, 0.1))),
    ]
