"""Tableware and kitchen vessels. Depth x, width y, height z [m]; round ones fit the smaller of x and y."""

from __future__ import annotations

from semmap.nodes.sim_node.models.forms import (
    BLACK,
    DARK,
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
    with_cavity,
)


def cup(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A cup with a handle towards +y. It looks hollow, but collides as a solid."""
    radius = min(0.5 * x, 0.4 * y)
    shift = -(y / 2 - radius)
    wall = 0.1 * radius
    body = [
        *visual(column(0.8 * radius, 0, 2 * wall, shade(colour, 0.85))),
        *visual(ring((0.85 * radius, radius), wall, z, wall, colour)),
        *collision(column(0.9 * radius, 0, z, colour)),
    ]
    grip = y / 2 - (shift + radius)
    handle = [
        pill(0.09 * radius, 0.55 * z, (0, shift + radius + 0.75 * grip * 2 - 0.09 * radius, 0.5 * z), colour),
        *(
            rod(0.09 * radius, 1.4 * grip, (0, shift + radius + 0.6 * grip, height * z), colour, ALONG_Y)
            for height in (0.28, 0.72)
        ),
    ]
    return [
        *shifted(body, y=shift),
        *visual(handle),
    ]


def glass(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A plain tumbler, wider at the top. It looks hollow, but collides as a solid."""
    radius = min(x, y) / 2
    wall = 0.08 * radius
    return [
        *visual(column(0.75 * radius, 0, 0.08 * z, shade(colour, 0.8))),
        *visual(ring((0.78 * radius, radius), 0.04 * z, z, wall, colour)),
        *collision(column(0.85 * radius, 0, z, colour)),
    ]


def bowl(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A foot and two flaring rings; it collides as a hollow body."""
    radius = min(x, y) / 2
    wall = min(0.006, 0.1 * radius)
    return [
        column(0.5 * radius, 0, 0.15 * z, colour),
        *visual(ring((0.48 * radius, 0.82 * radius), 0.04 * z, 0.5 * z, wall, shade(colour, 0.9))),
        *visual(ring((0.8 * radius, radius), 0.45 * z, z, wall, colour)),
        *collision(ring((0.55 * radius, 0.98 * radius), 0.1 * z, z, wall, colour, count=8)),
    ]


def plate(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Flat, with a raised rim."""
    radius = min(x, y) / 2
    return [
        column(0.65 * radius, 0, 0.5 * z, shade(colour, 0.92)),
        *visual(ring((0.65 * radius, radius), 0.1 * z, z, 0.004, colour, count=16)),
        *collision(column(0.95 * radius, 0.4 * z, 0.7 * z, colour)),
    ]


def can(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A tin with a shining rim at both ends and a label."""
    radius = min(x, y) / 2
    return [
        with_cavity(column(radius, 0, z, STEEL), is_open=False),
        *visual(column(1.015 * radius, 0.1 * z, 0.9 * z, colour)),
        *visual(column(0.85 * radius, z, z + 0.001, shade(STEEL, 0.8))),
    ]


def bottle(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Body, sloping shoulder, neck and cap."""
    radius = min(x, y) / 2
    neck = 0.36 * radius
    return [
        with_cavity(column(radius, 0, 0.58 * z, colour), is_open=False),
        *visual(column(1.01 * radius, 0.16 * z, 0.46 * z, WHITE)),
        *turned([(radius, 0.58 * z), (neck, 0.78 * z), (neck, 0.94 * z)], colour, steps=8),
        *visual(column(1.25 * neck, 0.92 * z, z, shade(colour, 0.5))),
        *collision(column(0.6 * radius, 0.58 * z, 0.75 * z, colour)),
        *collision(column(neck, 0.75 * z, z, colour)),
    ]


def jar(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A stout glass with a screw lid."""
    radius = min(x, y) / 2
    return [
        with_cavity(column(radius, 0, 0.78 * z, colour), is_open=True),
        *turned([(radius, 0.78 * z), (0.82 * radius, 0.84 * z)], colour, steps=3),
        column(0.88 * radius, 0.82 * z, z, (0.75, 0.2, 0.15)),
        *visual(column(1.01 * radius, 0.2 * z, 0.6 * z, WHITE)),
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
        *visual(
            box((0.3 * x, 1.01 * wall, 0.4 * z), (0, s * (y - wall) / 2, 0.75 * z), DARK) for s in (-1, 1)
        ),
    ]


def pot(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A cooking pot with two ears and a lid."""
    radius = min(x / 2, 0.4 * y)
    return [
        with_cavity(column(radius, 0, 0.78 * z, colour), is_open=True),
        *visual(column(1.03 * radius, 0.76 * z, 0.82 * z, shade(colour, 0.8))),
        *visual(ball((1.96 * radius, 1.96 * radius, 0.24 * z), (0, 0, 0.8 * z), shade(colour, 1.15))),
        *visual(ball((0.03, 0.03, 0.12 * z), (0, 0, 0.94 * z), BLACK)),
        *visual(
            box((0.5 * radius, y / 2 - radius, 0.07 * z), (0, s * (y / 2 + radius) / 2, 0.66 * z), BLACK)
            for s in (-1, 1)
        ),
    ]


def pan(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A frying pan with its handle towards +x."""
    radius = min(y / 2, 0.3 * x)
    middle = -(x / 2 - radius)
    body = [
        column(0.85 * radius, 0, 0.12 * z, colour),
        *ring((0.86 * radius, radius), 0.02 * z, z, 0.006, colour),
    ]
    grip = x - 2 * radius
    return [
        *shifted(body, x=middle),
        *visual(box((grip, 0.12 * radius, 0.25 * z), ((x - grip) / 2, 0, 0.8 * z), BLACK)),
    ]


def pitcher(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A bellied jug with a spout towards +y and a handle behind."""
    radius = min(x / 2, 0.42 * y)
    return [
        *turned(
            [(0.7 * radius, 0), (radius, 0.35 * z), (0.6 * radius, 0.78 * z), (0.72 * radius, z)], colour
        ),
        *collision(with_cavity(column(0.75 * radius, 0, z, colour), is_open=True)),
        *visual(
            box((0.5 * radius, 0.5 * radius, 0.1 * z), (0, 0.75 * radius, 0.94 * z), colour, about("x", 0.5))
        ),
        *visual(pill(0.1 * radius, 0.6 * z, (0, -1.35 * radius, 0.58 * z), colour)),
        *visual(
            box((0.15 * radius, 0.7 * radius, 0.05 * z), (0, -1.0 * radius, h * z), colour)
            for h in (0.36, 0.83)
        ),
    ]


def vase(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Narrow foot, wide belly, narrow neck, flaring lip."""
    radius = min(x, y) / 2
    profile = [(0.55 * radius, 0), (radius, 0.4 * z), (0.35 * radius, 0.8 * z), (0.65 * radius, z)]
    body = with_cavity(column(0.6 * radius, 0, z, colour), is_open=True)
    return [*turned(profile, colour, steps=9), *collision(body)]


def wine_bottle(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A slim bottle with high shoulders and a long neck."""
    radius = min(x, y) / 2
    neck = 0.36 * radius
    return [
        with_cavity(column(radius, 0, 0.6 * z, colour), is_open=False),
        *turned([(radius, 0.6 * z), (neck, 0.72 * z), (neck, 0.9 * z)], colour, steps=8),
        *visual(column(1.15 * neck, 0.86 * z, z, (0.45, 0.08, 0.12))),
        *visual(column(1.01 * radius, 0.15 * z, 0.42 * z, (0.92, 0.88, 0.75))),
        *collision(column(neck, 0.6 * z, z, colour)),
    ]


def fork(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Four tines towards +x."""
    tines = visual(
        box((0.26 * x, 0.12 * y, 0.6 * z), (0.37 * x, y * k, 0.5 * z), colour)
        for k in (-0.42, -0.14, 0.14, 0.42)
    )
    return [
        *tines,
        *visual(box((0.16 * x, 0.96 * y, 0.6 * z), (0.17 * x, 0, 0.5 * z), colour)),
        *visual(box((0.6 * x, 0.35 * y, 0.7 * z), (-0.2 * x, 0, 0.5 * z), shade(colour, 0.9))),
        *collision(slab(x, 0.9 * y, 0, z, colour)),
    ]


def knife(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A blade towards +x on a dark handle."""
    return [
        *visual(box((0.5 * x, 0.9 * y, 0.3 * z), (0.2 * x, 0, 0.5 * z), colour)),
        *visual(ball((0.18 * x, 0.9 * y, 0.3 * z), (0.41 * x, 0, 0.5 * z), colour)),
        *visual(box((0.45 * x, 0.8 * y, z), (-0.275 * x, 0, 0.5 * z), DARK)),
        *collision(slab(x, 0.9 * y, 0, z, colour)),
    ]


def spoon(x: float, y: float, z: float, colour: Colour) -> Parts:
    """An oval bowl towards +x."""
    return [
        *visual(ball((0.32 * x, y, z), (0.34 * x, 0, 0.5 * z), colour)),
        *visual(ball((0.25 * x, 0.7 * y, 0.5 * z), (0.34 * x, 0, 0.8 * z), shade(colour, 0.7))),
        *visual(box((0.7 * x, 0.28 * y, 0.5 * z), (-0.15 * x, 0, 0.4 * z), colour)),
        *collision(slab(x, 0.8 * y, 0, 0.9 * z, colour)),
    ]


def cutting_board(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A board with a grip hole."""
    return [
        slab(x, y, 0, z, colour),
        *visual(box((0.3 * x, 0.06 * y, z + 0.001), (0, 0.42 * y, 0.5 * z), DARK)),
    ]
