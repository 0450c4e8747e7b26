"""Bathroom articles. Depth x, width y, height z [m]."""

from __future__ import annotations

from semmap.nodes.sim_node.models.forms import PAPER, WHITE, column, shade, slab
from semmap.nodes.sim_node.models.parts import ALONG_Y, Colour, Parts, ball, box, collision, rod, visual


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
