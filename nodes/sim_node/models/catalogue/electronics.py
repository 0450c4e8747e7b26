"""Electronics. Screens face +x. Depth x, width y, height z [m]."""

from __future__ import annotations

import math

from semmap.nodes.sim_node.models.forms import (
    BLACK,
    BRASS,
    DARK,
    GREY,
    LIGHT,
    PAPER,
    SCREEN,
    STEEL,
    WHITE,
    column,
    front,
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
    rod,
    visual,
)

_DIGIT: Colour = (0.3, 0.95, 0.7)


def television(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A flat screen on two feet."""
    foot = 0.08 * z
    return [
        box((0.25 * x, y, z - foot), (0, 0, (z + foot) / 2), colour),
        *visual(
            box((0.02 * x, 0.96 * y, 0.93 * (z - foot)), (0.125 * x, 0, (z + foot) / 2), (0.13, 0.20, 0.32))
        ),
        *visual(
            box(
                (0.02 * x, 0.5 * y, 0.25 * z),
                (0.13 * x, -0.15 * y, 0.68 * z),
                (0.22, 0.34, 0.50),
                about("x", 0.4),
            )
        ),
        *(box((x, 0.03, foot), (0, side * 0.35 * y, foot / 2), DARK) for side in (-1, 1)),
    ]


def radio(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A box with a cloth front, a dial, two knobs and an aerial."""
    body = 0.62 * z
    return [
        box((0.94 * x, y, body), (-0.03 * x, 0, body / 2), colour),
        *visual(box((0.03 * x, 0.5 * y, 0.8 * body), (0.45 * x, -0.2 * y, body / 2), (0.80, 0.72, 0.55))),
        *visual(box((0.03 * x, 0.36 * y, 0.3 * body), (0.45 * x, 0.26 * y, 0.68 * body), PAPER)),
        *visual(
            rod(0.06 * y, 0.08 * x, (0.46 * x, y * k, 0.28 * body), BRASS, ALONG_X) for k in (0.17, 0.36)
        ),
        *visual(rod(0.004, 0.45 * z, (-0.3 * x, 0.4 * y, 0.78 * z), STEEL)),
    ]


def recorder(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A flat player: a cassette's flap, a display with digits, keys and a knob, on four feet."""
    foot, face = 0.12 * z, 0.02 * x
    edge = (x - face) / 2
    feet = [
        rod(0.04 * y, foot, (0.38 * x * sx, 0.4 * y * sy, foot / 2), BLACK)
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    return [
        *visual(feet),
        *collision(slab(0.98 * x, y, 0, foot, colour)),
        box((0.98 * x, y, z - foot), (-0.01 * x, 0, (z + foot) / 2), colour),
        *front(x / 2 - 0.0045, 0.98 * y, 0.86 * (z - foot), (0, (z + foot) / 2), STEEL, deep=face),
        *front(x / 2 - 0.003, 0.46 * y, 0.34 * z, (-0.22 * y, 0.70 * z), BLACK, deep=face),
        *front(x / 2 - 0.001, 0.40 * y, 0.05 * z, (-0.22 * y, 0.60 * z), GREY, deep=face),
        *front(x / 2 - 0.003, 0.28 * y, 0.30 * z, (0.18 * y, 0.70 * z), BLACK, deep=face),
        *visual(
            box((face, 0.025 * y, 0.2 * z), (edge, (0.10 + 0.05 * i + 0.03 * (i > 1)) * y, 0.7 * z), _DIGIT)
            for i in range(4)
        ),
        *visual(
            box((face, 0.05 * y, 0.1 * z), (edge, (-0.40 + 0.075 * i) * y, 0.34 * z), DARK) for i in range(5)
        ),
        *visual(rod(0.22 * z, 0.03 * x, (x / 2 - 0.015 * x, 0.41 * y, 0.52 * z), DARK, ALONG_X)),
    ]


def phone(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A desk telephone: a sloping body, keys, and the receiver across it."""
    receiver = 0.78 * z
    return [
        slab(x, y, 0, 0.35 * z, colour),
        *visual(box((0.8 * x, 0.9 * y, 0.3 * z), (-0.05 * x, 0, 0.42 * z), colour, about("y", 0.2))),
        *visual(
            box(
                (0.09 * x, 0.1 * y, 0.06 * z),
                (0.02 * x + 0.13 * x * i, 0.08 * y + 0.14 * y * j, 0.56 * z - 0.03 * z * i),
                PAPER,
            )
            for i in range(3)
            for j in range(3)
        ),
        *visual(pill(0.12 * z, 0.94 * x, (0, -0.28 * y, receiver), DARK, ALONG_X)),
        *visual(
            rod(0.2 * z, 0.25 * z, (0.36 * x * s, -0.28 * y, receiver - 0.08 * z), DARK) for s in (-1, 1)
        ),
        *collision(box((0.9 * x, 0.3 * y, 0.6 * z), (0, -0.28 * y, 0.6 * z), colour)),
    ]


def remote_control(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A long slab with buttons, the red one at the top."""
    buttons = visual(
        rod(0.11 * y, 0.002, (x * (0.2 - 0.11 * i), 0.26 * y * j, z), LIGHT)
        for i in range(6)
        for j in (-1, 0, 1)
    )
    return [
        slab(x, y, 0, z, colour),
        *buttons,
        *visual(rod(0.14 * y, 0.003, (0.4 * x, -0.2 * y, z), (0.85, 0.15, 0.15))),
    ]


def camera(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A body with a lens towards +x and a viewfinder hump."""
    body = 0.8 * z
    return [
        box((0.45 * x, y, body), (-0.275 * x, 0, body / 2), colour),
        *visual(rod(0.36 * body, 0.5 * x, (0.2 * x, 0, 0.48 * body), GREY, ALONG_X)),
        *visual(rod(0.28 * body, 0.02 * x, (0.46 * x, 0, 0.48 * body), (0.15, 0.20, 0.40), ALONG_X)),
        *visual(box((0.4 * x, 0.3 * y, 0.2 * z), (-0.27 * x, 0, 0.9 * z), colour)),
        *visual(rod(0.06 * y, 0.05 * z, (-0.25 * x, 0.34 * y, 0.83 * z), STEEL)),
        *collision(box((0.55 * x, 0.4 * y, 0.7 * body), (0.22 * x, 0, 0.36 * body), colour)),
    ]


def headphones(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Two cups under a band, standing."""
    radius = 0.42 * y
    centre = z - radius - 0.04 * y
    band = visual(
        box(
            (0.25 * x, 2 * math.pi * radius / 20, 0.08 * y),
            (0, -radius * math.cos(a), centre + radius * math.sin(a)),
            colour,
            about("x", math.pi / 2 - a),
        )
        for a in (math.pi * (i + 0.5) / 10 for i in range(10))
    )
    cups = [
        rod(0.5 * min(x, z), 0.16 * y, (0, side * 0.4 * y, 0.5 * min(x, z)), DARK, ALONG_Y)
        for side in (-1, 1)
    ]
    return [*band, *visual(cups), *collision(slab(0.8 * x, y, 0, 0.75 * z, colour))]


def robot(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A domestic robot: a round base, a trunk with a screen, a head with two eyes, two arms."""
    radius = min(x, y) / 2
    head = 0.16 * z
    eyes = visual(
        ball((0.03, 0.05, 0.05), (0.5 * radius, 0.2 * radius * s, z - 0.45 * head), (0.2, 0.7, 0.95))
        for s in (-1, 1)
    )
    arms = visual(
        pill(0.1 * radius, 0.34 * z, (0.05 * radius, 0.72 * radius * s, 0.5 * z), shade(colour, 0.8))
        for s in (-1, 1)
    )
    return [
        column(radius, 0, 0.14 * z, DARK),
        *turned(
            [(0.9 * radius, 0.14 * z), (0.5 * radius, 0.28 * z), (0.58 * radius, 0.8 * z)], colour, steps=7
        ),
        *collision(column(0.6 * radius, 0.14 * z, z, colour)),
        *visual(box((0.1 * radius, 0.7 * radius, 0.2 * z), (0.54 * radius, 0, 0.58 * z), SCREEN)),
        *visual(ball((radius, 1.1 * radius, 1.1 * head), (0, 0, z - 0.55 * head), WHITE)),
        *eyes,
        *arms,
    ]


def speaker(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A box with a small and a big cone."""
    return [
        box((x - 0.008, y, z), (-0.004, 0, z / 2), colour),
        *visual(rod(0.36 * y, 0.01, (x / 2 - 0.006, 0, 0.34 * z), GREY, ALONG_X)),
        *visual(rod(0.14 * y, 0.012, (x / 2 - 0.006, 0, 0.34 * z), BLACK, ALONG_X)),
        *visual(rod(0.18 * y, 0.01, (x / 2 - 0.006, 0, 0.77 * z), GREY, ALONG_X)),
    ]
