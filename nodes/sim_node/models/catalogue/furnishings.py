"""Wall decoration and textiles. Depth x, width y, height z [m]."""

from __future__ import annotations

import math

from semmap.nodes.sim_node.models.forms import BLACK, GREY, PAPER, WHITE, shade, slab
from semmap.nodes.sim_node.models.parts import (
    ALONG_X,
    ALONG_Y,
    Colour,
    Parts,
    ball,
    box,
    collision,
    pill,
    rod,
    visual,
)


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
