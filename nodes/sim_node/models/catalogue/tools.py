"""Tools, for the hand and for the house. Depth x, width y, height z [m]."""

from __future__ import annotations

from semmap.nodes.sim_node.models.forms import STEEL, WOOD, column, ring, shifted, slab
from semmap.nodes.sim_node.models.parts import (
    ALONG_X,
    ALONG_Y,
    Colour,
    Parts,
    about,
    box,
    collision,
    rod,
    visual,
)


def scissors(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Two crossed blades, two rings."""
    blades = visual(
        box((0.62 * x, 0.14 * y, 0.5 * z), (0.18 * x, 0, z / 2), STEEL, about("z", 0.14 * s)) for s in (-1, 1)
    )
    rings = [
        part
        for s in (-1, 1)
        for part in shifted(
            ring((0.27 * y, 0.27 * y), 0.0, z, 0.06 * y, colour, count=8), x=-0.36 * x, y=0.23 * y * s
        )
    ]
    return [*blades, *visual(rings), *collision(slab(0.95 * x, 0.7 * y, 0, z, colour))]


def screwdriver(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A fat grip and a shaft towards +x."""
    radius = min(y, z) / 2
    return [
        rod(radius, 0.42 * x, (-0.29 * x, 0, radius), colour, ALONG_X),
        *visual(rod(0.25 * radius, 0.56 * x, (0.2 * x, 0, radius), STEEL, ALONG_X)),
        *visual(box((0.04 * x, 0.7 * radius, 0.2 * radius), (0.48 * x, 0, radius), STEEL)),
        *collision(slab(x, 1.4 * radius, 0, 0.3 * radius, colour)),
    ]


def wrench(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A shank with an open jaw at one end and a ring at the other."""
    jaws = visual(
        box((0.16 * x, 0.26 * y, z), (0.42 * x, 0.33 * y * s, z / 2), colour, about("z", 0.25 * s))
        for s in (-1, 1)
    )
    return [
        *visual(box((0.7 * x, 0.34 * y, 0.7 * z), (-0.05 * x, 0, z / 2), colour)),
        *visual(rod(0.42 * y, z, (0.27 * x, 0, z / 2), colour)),
        *jaws,
        *visual(shifted(ring((0.45 * y, 0.45 * y), 0, z, 0.2 * y, colour, count=10), x=-0.5 * x + 0.45 * y)),
        *collision(slab(x, 0.9 * y, 0, z, colour)),
    ]


def hammer(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A steel head across the end of a wooden haft."""
    return [
        box((0.82 * x, 0.22 * y, 0.7 * z), (-0.09 * x, 0, 0.5 * z), colour),
        *visual(box((0.12 * x, 0.7 * y, 0.9 * z), (0.42 * x, 0.05 * y, 0.5 * z), STEEL)),
        *visual(rod(0.5 * z, 0.15 * y, (0.42 * x, 0.425 * y, 0.5 * z), STEEL, ALONG_Y)),
        *visual(box((0.09 * x, 0.3 * y, 0.5 * z), (0.42 * x, -0.4 * y, 0.5 * z), STEEL, about("z", 0.3))),
        *collision(box((0.14 * x, y, z), (0.42 * x, 0, z / 2), STEEL)),
    ]


def broom(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Bristles below, a long stick."""
    head = 0.1 * z
    return [
        slab(x, y, 0, head, (0.80, 0.65, 0.35)),
        slab(0.8 * x, 0.9 * y, head, 1.3 * head, colour),
        column(0.013, 1.3 * head, z, WOOD),
    ]
