"""Books, papers and pens. Depth x, width y, height z [m]."""

from __future__ import annotations

from semmap.nodes.sim_node.models.forms import BLACK, BRASS, DARK, GREY, PAPER, WHITE, shade, slab
from semmap.nodes.sim_node.models.parts import ALONG_X, Colour, Parts, about, box, collision, rod, visual


def book(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Lying: two boards, white leaves, the spine at -y."""
    board = min(0.003, 0.15 * z)
    return [
        *visual(slab(x, y, 0, board, colour)),
        *visual(slab(x, y, z - board, z, colour)),
        *visual(box((0.96 * x, 0.96 * y, z - 2 * board), (0, 0, z / 2), PAPER)),
        *visual(box((x, 0.06 * y, z), (0, -0.47 * y, z / 2), colour)),
        *visual(box((0.5 * x, 0.5 * y, 0.001), (0.1 * x, 0.02 * y, z), BRASS)),
        *collision(slab(x, y, 0, z, colour)),
    ]


def magazine(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A glossy cover with a title bar."""
    return [
        slab(x, y, 0, z, colour),
        *visual(box((0.2 * x, 0.9 * y, 0.001), (-0.36 * x, 0, z), WHITE)),
        *visual(rod(0.22 * y, 0.001, (0.12 * x, 0, z), (0.95, 0.75, 0.55))),
    ]


def newspaper(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A folded sheet with a headline and columns."""
    lines = visual(
        box((0.02 * x, 0.4 * y, 0.001), (x * (-0.15 + 0.09 * i), 0.24 * y * s, z), GREY)
        for i in range(7)
        for s in (-1, 1)
    )
    return [
        slab(x, y, 0, z, colour),
        *visual(box((0.09 * x, 0.85 * y, 0.001), (-0.36 * x, 0, z), BLACK)),
        *lines,
    ]


def paper(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A sheet with lines of writing."""
    lines = visual(
        box((0.012 * x, 0.75 * y, 0.0006), (x * (-0.38 + 0.1 * i), 0, z), (0.3, 0.35, 0.5)) for i in range(8)
    )
    return [slab(x, y, 0, z, colour), *lines]


def envelope(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A cover with its flap and a stamp."""
    flap = visual(
        box((0.006, 0.55 * y, 0.001), (-0.18 * x, 0.23 * y * s, z), shade(colour, 0.75), about("z", 0.5 * s))
        for s in (-1, 1)
    )
    return [
        slab(x, y, 0, z, colour),
        *flap,
        *visual(box((0.2 * x, 0.13 * y, 0.001), (-0.34 * x, 0.4 * y, z), (0.8, 0.2, 0.2))),
    ]


def postcard(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A beach: sky, sea, sand."""
    return [
        slab(x, y, 0, z, WHITE),
        *visual(box((0.3 * x, 0.94 * y, 0.001), (-0.3 * x, 0, z), (0.55, 0.80, 0.95))),
        *visual(box((0.26 * x, 0.94 * y, 0.001), (-0.02 * x, 0, z), colour)),
        *visual(box((0.32 * x, 0.94 * y, 0.001), (0.27 * x, 0, z), (0.93, 0.85, 0.60))),
    ]


def folder(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A ring binder, standing, its labelled back to +x."""
    return [
        slab(x, y, 0, z, colour),
        *visual(box((0.002, 0.7 * y, 0.4 * z), (x / 2, 0, 0.62 * z), PAPER)),
        *visual(rod(0.25 * y, 0.003, (x / 2, 0, 0.2 * z), BLACK, ALONG_X)),
    ]


def pen(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A barrel, a cap, a tip."""
    radius = min(y, z) / 2
    return [
        *visual(rod(radius, 0.6 * x, (0.05 * x, 0, radius), colour, ALONG_X)),
        *visual(rod(1.0 * radius, 0.35 * x, (-0.325 * x, 0, radius), DARK, ALONG_X)),
        *visual(rod(0.5 * radius, 0.15 * x, (0.42 * x, 0, radius), BRASS, ALONG_X)),
        *collision(slab(x, y, 0, 2 * radius, colour)),
    ]
