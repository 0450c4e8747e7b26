"""Wall decoration, textiles, lamps, candles and plants. Depth x, width y, height z [m]."""

from __future__ import annotations

import math

from semmap.nodes.sim_node.models.forms import (
    BLACK,
    BRASS,
    DARK,
    GREY,
    PAPER,
    WHITE,
    WOOD,
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
    pill,
    product,
    rod,
    visual,
    with_cavity,
)

LEAF: Colour = (0.25, 0.50, 0.20)


def board(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A white board in a frame: a curve in blue, lines in red, and a tray with pens and a sponge."""
    face, ink = 0.111 * x, 0.014 * z
    blue, red = (0.15, 0.30, 0.75), (0.80, 0.15, 0.15)
    curve = [
        ball(
            (0.004, 0.09 * y, ink),
            (face, (-0.38 + 0.05 * i) * y, (0.62 + 0.05 * math.sin(0.8 * i)) * z),
            blue,
        )
        for i in range(9)
    ]
    lines = [
        box((0.003, width * y, ink), (face, (0.10 + width / 2) * y, (0.82 - 0.09 * i) * z), red)
        for i, width in enumerate((0.32, 0.26, 0.30, 0.16))
    ]
    pens = [
        rod(0.010, 0.12, (0.25 * x, (-0.18 + 0.12 * i) * y, 0.042), pen, ALONG_Y)
        for i, pen in enumerate((blue, red, BLACK))
    ]
    return [
        box((0.6 * x, y, z), (-0.2 * x, 0, z / 2), colour),
        *visual(box((0.02 * x + 0.002, 0.95 * y, 0.92 * z), (0.1 * x, 0, 0.5 * z), WHITE)),
        *visual([*curve, *lines, *pens]),
        *visual(box((0.9 * x, 0.5 * y, 0.02), (0.05 * x, 0, 0.02), GREY)),
        *visual(box((0.03, 0.10, 0.03), (0.25 * x, 0.2 * y, 0.045), (0.95, 0.80, 0.25))),
    ]


def clock(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A round wall clock facing +x."""
    radius = min(y, z) / 2
    return [
        rod(radius, 0.9 * x, (-0.05 * x, 0, z / 2), colour, ALONG_X),
        *visual(rod(0.88 * radius, 0.05 * x, (0.42 * x, 0, z / 2), PAPER, ALONG_X)),
        *visual(box((0.05 * x, 0.05 * radius, 0.7 * radius), (0.47 * x, 0, z / 2 + 0.3 * radius), BLACK)),
        *visual(box((0.05 * x, 0.5 * radius, 0.06 * radius), (0.47 * x, 0.22 * radius, z / 2), BLACK)),
    ]


def pillow(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Soft: high in the middle, with a round border."""
    radius, border = 0.3 * z, shade(colour, 0.92)
    edges = [
        *(pill(radius, x, (0, (y / 2 - radius) * s, z / 2), border, ALONG_X) for s in (-1, 1)),
        *(pill(radius, y, ((x / 2 - radius) * s, 0, z / 2), border, ALONG_Y) for s in (-1, 1)),
    ]
    inside = [
        box((x - 2 * radius, y - 2 * radius, 2 * radius), (0, 0, z / 2), border),
        ball((0.96 * x, 0.96 * y, 0.96 * z), (0, 0, z / 2), colour),
    ]
    return [*visual([*edges, *inside]), *collision(box((0.9 * x, 0.9 * y, z), (0, 0, z / 2), colour))]


def cushion(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A pillow that a button holds together."""
    return [
        *pillow(x, y, z, colour),
        *visual(ball((0.09 * x, 0.09 * x, 0.08 * z), (0, 0, 0.96 * z), shade(colour, 0.6))),
    ]


def rug(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A flat rug with a border."""
    return [
        slab(x, y, 0, z, colour),
        *visual(slab(0.86 * x, 0.9 * y, 0.5 * z, z + 0.001, shade(colour, 1.4))),
    ]


def lamp(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A standing or table lamp: foot, stem and a conical shade."""
    radius = min(x, y) / 2
    foot = 0.03 * z + 0.01
    shade_low = 0.68 * z
    return [
        column(0.8 * radius, 0, foot, DARK),
        column(max(0.05 * radius, 0.008), foot, z - 0.02, BRASS),
        *turned([(radius, shade_low), (0.6 * radius, z)], colour, steps=10),
        *collision(column(0.85 * radius, shade_low, z, colour)),
    ]


def hanging_lamp(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A pendant: a bowl of light on a wire, to hang from a ceiling."""
    radius = min(x, y) / 2
    return [
        *turned(
            [(radius, 0.0), (0.94 * radius, 0.17 * z), (0.7 * radius, 0.33 * z), (0.2 * radius, 0.45 * z)],
            colour,
            steps=5,
        ),
        *collision(column(0.8 * radius, 0, 0.45 * z, colour)),
        *visual(ball((0.5 * radius, 0.5 * radius, 0.2 * z), (0, 0, 0.1 * z), (1.0, 0.95, 0.7))),
        *visual(column(0.012, 0.45 * z, z, DARK)),
    ]


def candle(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Wax on a saucer, wick and flame."""
    radius = min(x, y) / 2
    return [
        column(radius, 0, 0.06 * z, BRASS),
        column(0.5 * radius, 0.06 * z, 0.8 * z, colour),
        *visual(column(0.05 * radius, 0.8 * z, 0.86 * z, BLACK)),
        *visual(ball((0.28 * radius, 0.28 * radius, 0.16 * z), (0, 0, 0.92 * z), (1.0, 0.75, 0.2))),
    ]


def flower_pot(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A clay pot with a rim and earth."""
    radius = min(x, y) / 2
    return [
        *turned([(0.68 * radius, 0), (0.92 * radius, 0.8 * z)], colour, steps=6),
        *collision(with_cavity(column(0.72 * radius, 0, 0.8 * z, colour), is_open=True)),
        column(radius, 0.8 * z, z, shade(colour, 0.9)),
        *visual(column(0.88 * radius, z, z + 0.002, (0.25, 0.17, 0.1))),
    ]


def plant(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A pot with a bush of leaves."""
    radius = 0.3 * min(x, y)
    pot = flower_pot(2 * radius, 2 * radius, 0.3 * z, (0.72, 0.38, 0.24))
    leaves = visual(
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
        *visual(column(0.012, 0.3 * z, 0.85 * z, WOOD)),
        *visual(ball((0.12 * x, 0.12 * y, 0.3 * z), (0, 0, 0.85 * z), colour)),
        *collision(column(0.8 * radius, 0.3 * z, 0.9 * z, colour)),
    ]


def flower(x: float, y: float, z: float, colour: Colour) -> Parts:
    """One bloom on a stalk in a small pot."""
    pot = min(x, y) * 0.6
    bloom = 0.93 * z
    petals = visual(
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
        *visual(column(0.006, 0.28 * z, bloom, LEAF)),
        *petals,
        *visual(ball((0.22 * x, 0.22 * y, 0.08 * z), (0, 0, bloom + 0.02 * z), (0.95, 0.8, 0.25))),
        *visual(
            ball((0.3 * x, 0.1 * y, 0.03 * z), (0.12 * x * s, 0, 0.5 * z), LEAF, about("y", -0.5 * s))
            for s in (-1, 1)
        ),
        *collision(column(0.3 * pot, 0.28 * z, 0.9 * z, colour)),
    ]
