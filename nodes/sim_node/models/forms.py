"""Shapes that many models share: legs, hollow walls, surfaces of revolution, panels."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise

from semmap.nodes.sim_node.models.parts import (
    Colour,
    Part,
    Parts,
    Role,
    Shape,
    Vec3,
    about,
    box,
    collision,
    pill,
    product,
    rod,
    visual,
)

WHITE: Colour = (0.93, 0.93, 0.91)
LIGHT: Colour = (0.80, 0.80, 0.78)
GREY: Colour = (0.55, 0.56, 0.58)
DARK: Colour = (0.20, 0.20, 0.22)
BLACK: Colour = (0.08, 0.08, 0.09)
STEEL: Colour = (0.70, 0.72, 0.75)
BRASS: Colour = (0.78, 0.62, 0.28)
WOOD: Colour = (0.62, 0.44, 0.26)
GLASSY: Colour = (0.66, 0.82, 0.88)
SCREEN: Colour = (0.10, 0.14, 0.20)
PAPER: Colour = (0.96, 0.94, 0.88)

WALL_M = 0.02
"""Minimum thickness of the walls of closed furniture."""


def shade(colour: Colour, factor: float) -> Colour:
    """Return `colour` made darker (factor < 1) or lighter (> 1)."""
    red, green, blue = (min(1.0, channel * factor) for channel in colour)
    return (red, green, blue)


def legs(x: float, y: float, height: float, thick: float, colour: Colour) -> Parts:
    """Return four square legs at the corners of a footprint x by y; each touches the floor in one point."""
    a, b = (x - thick) / 2, (y - thick) / 2
    corners = [(sx * a, sy * b, height / 2) for sx in (-1, 1) for sy in (-1, 1)]
    return [
        *visual(box((thick, thick, height), corner, colour) for corner in corners),
        *collision(pill(thick / 2, height, corner, colour) for corner in corners),
    ]


def slab(x: float, y: float, bottom: float, top: float, colour: Colour) -> Part:
    """Return a box of footprint x by y between two heights."""
    return box((x, y, top - bottom), (0.0, 0.0, (bottom + top) / 2), colour)


def solid(x: float, y: float, bottom: float, top: float) -> Parts:
    """Return an invisible box that collides in place of finer parts."""
    return collision(slab(x, y, bottom, top, GREY))


def front(x: float, y: float, z: float, centre: tuple[float, float], colour: Colour, *, deep: float) -> Parts:
    """Return a panel of width y and height z, with its outer face at depth x and its centre at (y, z)."""
    return visual(box((deep, y, z), (x - deep / 2, centre[0], centre[1]), colour))


def closed_box(
    size: Vec3, centre: Vec3, colour: Colour, *, boards: Sequence[float] = (), depth: float = 1.0
) -> Parts:
    """Return a closed box of full extents `size`: a single visible box, but colliding walls and boards.

    Boards are at these shares of its height, and extend over this share of its `depth` from the back, at -x.
    """
    x, y, z = size
    wall = min(max(WALL_M, 0.018 * max(x, y)), 0.1 * min(size))
    a, b, c = x - 2 * wall, y - 2 * wall, z - 2 * wall
    walls = [
        box((x, y, wall), (0.0, 0.0, (wall - z) / 2), colour),
        box((x, y, wall), (0.0, 0.0, (z - wall) / 2), colour),
        *(box((wall, y, c), (side * (x - wall) / 2, 0.0, 0.0), colour) for side in (-1, 1)),
        *(box((a, wall, c), (0.0, side * (y - wall) / 2, 0.0), colour) for side in (-1, 1)),
        *(
            box((depth * a, b, wall), ((depth - 1.0) * a / 2, 0.0, (share - 0.5) * z), colour)
            for share in boards
        ),
    ]
    return [
        *visual(box(size, centre, colour)),
        *collision(shifted(walls, x=centre[0], y=centre[1], z=centre[2])),
    ]


def hollow_box(x: float, y: float, z: float, wall: float, colour: Colour) -> Parts:
    """Return a floor and four walls, open at the top."""
    a, b, h = (x - wall) / 2, (y - wall) / 2, z - wall
    middle = wall + h / 2
    return [
        slab(x, y, 0.0, wall, colour),
        box((wall, y, h), (a, 0.0, middle), colour),
        box((wall, y, h), (-a, 0.0, middle), colour),
        box((x - 2 * wall, wall, h), (0.0, b, middle), colour),
        box((x - 2 * wall, wall, h), (0.0, -b, middle), colour),
    ]


def ring(
    radii: tuple[float, float], bottom: float, top: float, wall: float, colour: Colour, *, count: int = 12
) -> Parts:
    """Return a round wall of flat staves.

    Its outer radius is `radii[0]` at the bottom and `radii[1]` at the top.
    """
    low, high = radii
    tilt = math.atan2(high - low, top - bottom)
    length = math.hypot(high - low, top - bottom) - wall * abs(math.sin(tilt))
    parts = []
    for index in range(count):
        angle = 2 * math.pi * (index + 0.5) / count
        apothem = (low + high) / 2 * math.cos(math.pi / count) - wall / 2
        width = 2 * (max(low, high)) * math.sin(math.pi / count)
        turn = product(about("z", angle), about("y", tilt))
        centre: Vec3 = (apothem * math.cos(angle), apothem * math.sin(angle), (bottom + top) / 2)
        parts.append(box((wall, width, length), centre, colour, turn))
    return parts


def turned(profile: Sequence[tuple[float, float]], colour: Colour, *, steps: int = 6) -> Parts:
    """Return a solid of revolution as a visual part.

    It consists of discs through the points (radius, height), linear between them.
    """
    discs: Parts = []
    for (r0, z0), (r1, z1) in pairwise(profile):
        count = 1 if math.isclose(r0, r1) else steps
        for index in range(count):
            low, high = z0 + (z1 - z0) * index / count, z0 + (z1 - z0) * (index + 1) / count
            radius = r0 + (r1 - r0) * (index + 0.5) / count
            discs.append(
                Part(
                    Shape.CYLINDER,
                    (radius, radius, (high - low) / 2),
                    (0, 0, (low + high) / 2),
                    colour,
                    role=Role.VISUAL,
                )
            )
    return discs


def column(radius: float, bottom: float, top: float, colour: Colour) -> Part:
    """Return an upright cylinder between two heights."""
    return rod(radius, top - bottom, (0.0, 0.0, (bottom + top) / 2), colour)


def shifted(parts: Iterable[Part], *, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Parts:
    """Return the parts shifted, with their joints."""

    def there(point: Vec3) -> Vec3:
        return (float(point[0] + x), float(point[1] + y), float(point[2] + z))

    return [
        replace(
            part,
            centre=there(part.centre),
            joint=part.joint and replace(part.joint, anchor=there(part.joint.anchor)),
        )
        for part in parts
    ]
