"""Computers and peripherals. Screens face +x. Depth x, width y, height z [m]."""

from __future__ import annotations

import math

from semmap.nodes.sim_node.models.forms import (
    BLACK,
    DARK,
    GREY,
    LIGHT,
    STEEL,
    WHITE,
    front,
    shade,
    slab,
    solid,
)
from semmap.nodes.sim_node.models.parts import (
    ALONG_X,
    Colour,
    Joint,
    Parts,
    Vec3,
    about,
    box,
    moving,
    rod,
    visual,
)


def monitor(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A screen on a stem and a plate."""
    low = 0.28 * z
    return [
        box((0.15 * x, y, z - low), (0.1 * x, 0, (z + low) / 2), colour),
        *visual(
            box((0.02 * x, 0.95 * y, 0.92 * (z - low)), (0.18 * x, 0, (z + low) / 2), (0.20, 0.45, 0.70))
        ),
        *visual(box((0.01 * x, 0.5 * y, 0.3 * z), (0.195 * x, -0.1 * y, 0.7 * z), WHITE)),
        box((0.1 * x, 0.1 * y, 0.5 * z), (-0.05 * x, 0, 0.27 * z), STEEL),
        box((x, 0.42 * y, 0.03 * z), (0, 0, 0.015 * z), STEEL),
    ]


def computer(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A tower: a disc drive, a card reader, a lit button, two sockets, vents in front and at a side."""
    face = x / 2 - 0.003
    return [
        box((x - 0.006, y, z), (-0.003, 0, z / 2), colour),
        *front(x / 2 - 0.003, 0.94 * y, 0.97 * z, (0, z / 2), shade(colour, 1.35), deep=0.003),
        *front(x / 2 - 0.001, 0.8 * y, 0.09 * z, (0, 0.88 * z), LIGHT, deep=0.004),
        *front(x / 2, 0.7 * y, 0.008 * z, (0, 0.885 * z), DARK, deep=0.004),
        *front(x / 2, 0.12 * y, 0.018 * z, (0.28 * y, 0.855 * z), DARK, deep=0.004),
        *front(x / 2 - 0.001, 0.8 * y, 0.06 * z, (0, 0.78 * z), GREY, deep=0.004),
        *visual(rod(0.11 * y, 0.004, (face, 0, 0.66 * z), STEEL, ALONG_X)),
        *visual(rod(0.07 * y, 0.006, (face, 0, 0.66 * z), (0.3, 0.7, 0.95), ALONG_X)),
        *visual(
            box((0.004, 0.10 * y, 0.02 * z), (face + 0.001, 0.2 * y * s, 0.56 * z), BLACK) for s in (-1, 1)
        ),
        *visual(
            box((0.004, 0.7 * y, 0.015 * z), (face + 0.001, 0, (0.08 + 0.06 * i) * z), BLACK)
            for i in range(7)
        ),
        *visual(
            box((0.03 * x, 0.002, 0.22 * z), ((-0.15 + 0.08 * i) * x, -y / 2 + 0.0009, 0.6 * z), BLACK)
            for i in range(4)
        ),
    ]


def laptop(x: float, y: float, z: float, colour: Colour) -> Parts:
    """An open lid at -x over a keyboard."""
    deck, tilt = 0.08 * z, -0.3
    lid: Vec3 = (-0.40 * x - 0.02, 0, z / 2)
    shut = math.pi / 2 - tilt
    joint = Joint(
        name="lid",
        kind="hinge",
        anchor=(lid[0] + math.tan(tilt) * (deck - z / 2), 0.0, deck + 0.012 * x),
        axis=(0.0, 1.0, 0.0),
        range=(0.0, shut - 0.02),
        closed=shut - 0.02,
    )
    screen = [
        box((0.02 * x, y, 0.98 * z), lid, colour, about("y", tilt)),
        *visual(
            box(
                (0.004, 0.93 * y, 0.84 * z),
                (lid[0] + 0.013 * x, 0, lid[2] + 0.01 * z),
                (0.25, 0.55, 0.80),
                about("y", tilt),
            )
        ),
    ]
    return [
        slab(x * 0.86, y, 0, deck, colour),
        *visual(box((0.4 * x, 0.88 * y, 0.002), (-0.08 * x, 0, deck), DARK)),
        *visual(box((0.16 * x, 0.34 * y, 0.002), (0.28 * x, 0, deck), shade(colour, 0.8))),
        *moving(joint, screen),
    ]


def keyboard(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Rows of keys on a plate."""
    keys = visual(
        box(
            (0.15 * x, (0.5 * y if row == 4 else 0.052 * y), 0.5 * z),
            (x * (0.4 - 0.2 * (4 - row)), y * place, 0.75 * z),
            LIGHT,
        )
        for row in range(5)
        for place in ([0.0] if row == 4 else [-0.455 + 0.07 * i for i in range(14)])
    )
    return [slab(x, y, 0, 0.6 * z, colour), *keys, *solid(0.9 * x, 0.95 * y, 0.6 * z, z)]


def router(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A flat box with two aerials and lights."""
    body = 0.22 * z
    return [
        slab(x, y, 0, body, colour),
        *visual(
            rod(0.012 * z + 0.003, 0.9 * z, (-0.42 * x, side * 0.38 * y, 0.55 * z), DARK) for side in (-1, 1)
        ),
        *visual(
            box((0.004, 0.02, 0.2 * body), (x / 2, y * (0.08 * i - 0.2), body / 2), (0.3, 0.9, 0.4))
            for i in range(6)
        ),
    ]


def smartphone(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A slate with a bright screen and a lens."""
    return [
        slab(x, y, 0, z, colour),
        *visual(box((0.93 * x, 0.9 * y, 0.001), (0, 0, z), (0.20, 0.42, 0.65))),
        *visual(
            box((0.14 * x, 0.2 * y, 0.001), (-0.3 * x + 0.2 * x * i, 0.22 * y * j, z + 0.0005), WHITE)
            for i in range(4)
            for j in (-1, 1)
        ),
    ]


def tablet(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A big slate with a wide border and a button."""
    return [
        slab(x, y, 0, z, colour),
        *visual(box((0.8 * x, 0.86 * y, 0.001), (-0.02 * x, 0, z), (0.30, 0.55, 0.75))),
        *visual(rod(0.035 * x, 0.001, (0.44 * x, 0, z), GREY)),
    ]


def printer(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A box with paper behind and a tray in front."""
    return [
        box((0.7 * x, y, 0.7 * z), (-0.05 * x, 0, 0.35 * z), colour),
        *visual(box((0.02, 0.6 * y, 0.45 * z), (-0.34 * x, 0, 0.77 * z), WHITE, about("y", -0.25))),
        *visual(box((0.25 * x, 0.65 * y, 0.03), (0.37 * x, 0, 0.2 * z), DARK)),
        *visual(box((0.3 * x, 0.55 * y, 0.008), (0.33 * x, 0, 0.23 * z), WHITE)),
        *visual(box((0.5 * x, 0.9 * y, 0.02), (-0.05 * x, 0, 0.7 * z), DARK)),
    ]
