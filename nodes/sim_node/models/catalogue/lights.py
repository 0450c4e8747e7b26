"""Lamps and candles. Depth x, width y, height z [m]."""

from __future__ import annotations

from semmap.nodes.sim_node.models.forms import BLACK, BRASS, DARK, column, turned
from semmap.nodes.sim_node.models.parts import Colour, Parts, ball, collision, visual


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
