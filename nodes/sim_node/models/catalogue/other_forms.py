"""Alternative forms of things in the catalogue: bottles, cans, cups, glasses, cartons, books.

Depth x, width y, height z [m]; round ones fit the smaller of x and y. Perception is trained on scenes with
some of these, so a visible change of them changes its samples.
"""

from __future__ import annotations

import math

from semmap.nodes.sim_node.models.catalogue.tableware import glass
from semmap.nodes.sim_node.models.forms import PAPER, column, hollow_box, shade, shifted, slab, turned
from semmap.nodes.sim_node.models.openings import GAP_M, SIDES
from semmap.nodes.sim_node.models.parts import (
    ALONG_X,
    Colour,
    Joint,
    Parts,
    about,
    ball,
    box,
    collision,
    moving,
    pill,
    rod,
    visual,
    with_cavity,
)


def packet(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A carton of goods, printed on all sides, with two flaps.

    A single lid that is thrown open would tip a light box over.
    """
    wall = min(0.004, 0.1 * min(x, y, z))
    body, wide = z - wall - GAP_M, y / 2 - GAP_M
    dark, thin = shade(colour, 0.7), 0.001
    flaps: Parts = []
    for side, name in SIDES:
        joint = Joint(
            name=name,
            kind="hinge",
            anchor=(0.0, side * y / 2, z - wall / 2),
            axis=(-float(side), 0.0, 0.0),
            range=(0.0, math.pi),
            friction=0.01,
        )
        middle = side * (y / 4 + GAP_M / 2)
        board = box((x, wide, wall), (0.0, middle, z - wall / 2), shade(colour, 0.9))
        flaps += moving(joint, [board, *visual(box((0.6 * x, 0.6 * wide, thin), (0.0, middle, z), PAPER))])
    return [
        *hollow_box(x, y, body, wall, colour),
        *visual(box((thin, 0.9 * y, 0.3 * body), (s * x / 2, 0.0, 0.68 * body), PAPER) for s in (-1, 1)),
        *visual(box((thin, 0.9 * y, 0.12 * body), (s * x / 2, 0.0, 0.2 * body), dark) for s in (-1, 1)),
        *visual(box((0.7 * x, thin, 0.4 * body), (0.0, s * y / 2, 0.5 * body), dark) for s in (-1, 1)),
        *flaps,
    ]


def standing_book(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Upright, its spine with a title in front."""
    board = min(0.003, 0.15 * y)
    return [
        *visual(box((x, board, z), (0.0, s * (y - board) / 2, z / 2), colour) for s in (-1, 1)),
        *visual(box((0.96 * x, y - 2 * board, 0.97 * z), (0.0, 0.0, z / 2), PAPER)),
        *visual(box((0.05 * x, y, z), (0.475 * x, 0.0, z / 2), colour)),
        *visual(box((0.001, 0.6 * y, 0.4 * z), (x / 2, 0.0, 0.6 * z), shade(colour, 1.8))),
        *collision(slab(x, y, 0.0, z, colour)),
    ]


def plain_ball(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A ball with a seam."""
    return [
        ball((x, y, z), (0.0, 0.0, z / 2), colour),
        *visual(rod(0.503 * min(x, y), 0.02 * z, (0.0, 0.0, z / 2), shade(colour, 0.6), about("x", 0.6))),
    ]


def flat_bottle(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A bottle of shampoo, mustard or oil: a flat body with rounded sides, shoulders, a cap."""
    body, cap = 0.72 * z, min(x, y) * 0.28
    rounded = min(x, y) / 2
    sides = max(x, y) - 2 * rounded
    along = (1.0, 0.0) if x > y else (0.0, 1.0)
    ends = [
        shifted([column(rounded, 0.0, body, colour)], x=s * sides / 2 * along[0], y=s * sides / 2 * along[1])
        for s in (-1, 1)
    ]
    middle = (
        max(sides * along[0], x - 2 * rounded * along[0]),
        max(sides * along[1], y - 2 * rounded * along[1]),
    )
    return [
        with_cavity(slab(*middle, 0.0, body, colour), is_open=False),
        *(part for end in ends for part in end),
        *visual(ball((0.9 * x, 0.9 * y, 0.34 * z), (0.0, 0.0, 0.70 * z), colour)),
        column(cap, body, z, shade(colour, 0.5)),
    ]


def spray_bottle(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A body that narrows, and a head with a nozzle and a trigger towards +x."""
    radius = min(0.8 * x, y) / 2
    neck, dark = 0.35 * radius, shade(colour, 0.4)
    return shifted(
        [
            with_cavity(column(radius, 0.0, 0.55 * z, colour), is_open=False),
            *turned([(radius, 0.55 * z), (neck, 0.78 * z)], colour, steps=6),
            *collision(column(neck, 0.55 * z, 0.8 * z, colour)),
            column(neck, 0.76 * z, 0.86 * z, dark),
            *visual(box((x - 0.6 * radius, 0.7 * neck, 0.12 * z), (x / 2 - radius / 2, 0.0, 0.93 * z), dark)),
            *visual(
                box(
                    (0.2 * radius, 0.5 * neck, 0.16 * z),
                    (0.9 * radius, 0.0, 0.80 * z),
                    dark,
                    about("y", -0.4),
                )
            ),
        ],
        x=radius - x / 2,
    )


def drink_can(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A can, narrower at both ends."""
    radius = min(x, y) / 2
    return [
        column(radius, 0.06 * z, 0.9 * z, colour),
        *turned([(0.8 * radius, 0.0), (radius, 0.06 * z)], colour, steps=3),
        *turned([(radius, 0.9 * z), (0.8 * radius, z)], colour, steps=3),
        *collision(with_cavity(column(0.9 * radius, 0.0, z, colour), is_open=False)),
    ]


def tumbler(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A cup without a handle, wider at the top, with a floor."""
    radius, wall = min(x, y) / 2, 0.07 * min(x, y) / 2
    shell = glass(x, y, z, colour)
    return [*shell, *visual(column(0.76 * radius, 0.0, 2 * wall, shade(colour, 0.8)))]


def wine_glass(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A foot, a stem and a bowl."""
    radius = min(x, y) / 2
    bowl = [(0.1 * radius, 0.46 * z), (0.8 * radius, 0.6 * z), (radius, 0.75 * z), (0.8 * radius, z)]
    return [
        column(0.9 * radius, 0.0, 0.02 * z, colour),
        column(0.1 * radius, 0.0, 0.5 * z, colour),
        *turned(bowl, colour, steps=6),
        *collision(with_cavity(column(0.9 * radius, 0.5 * z, z, colour), is_open=True)),
    ]


def teapot(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A round body with a spout towards +y, a handle and a lid."""
    radius = min(x, 0.62 * y) / 2
    body = (2 * radius, 2 * radius, 0.82 * z)
    return [
        with_cavity(ball(body, (0.0, 0.0, 0.41 * z), colour), is_open=False),
        *visual(pill(0.16 * radius, 0.24 * y, (0.0, 0.5 * y - 0.1 * y, 0.55 * z), colour, about("x", -0.7))),
        *visual(pill(0.12 * radius, 0.45 * z, (0.0, 0.1 * radius - 0.5 * y, 0.5 * z), colour)),
        *visual(rod(0.1 * radius, 0.2 * y, (0.0, -0.38 * y, 0.66 * z), colour, about("x", math.pi / 2))),
        *visual(rod(0.1 * radius, 0.2 * y, (0.0, -0.38 * y, 0.32 * z), colour, about("x", math.pi / 2))),
        *visual(column(0.5 * radius, 0.75 * z, 0.88 * z, shade(colour, 0.9))),
        *visual(ball((0.3 * radius, 0.3 * radius, 0.14 * z), (0.0, 0.0, 0.93 * z), colour)),
    ]


def skillet(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A pan with low walls and one long handle towards +x."""
    radius = min(0.31 * x, y / 2)
    side = radius - x / 2
    return [
        *shifted([column(0.9 * radius, 0.0, 0.12 * z, colour)], x=side),
        *shifted(turned([(0.86 * radius, 0.1 * z), (radius, 0.85 * z)], shade(colour, 1.2), steps=4), x=side),
        *visual(
            pill(
                0.09 * radius,
                x - 2 * radius,
                (radius + (x - 2 * radius) / 2 + side, 0.0, 0.8 * z),
                colour,
                ALONG_X,
            )
        ),
    ]


def steady_teapot(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A teapot on an invisible colliding foot."""
    return [*teapot(x, y, z, colour), *collision(column(0.25 * min(x, 0.62 * y), 0.0, 0.2 * z, colour))]
