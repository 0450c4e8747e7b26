"""Chairs, tables and beds. Depth x, width y, height z [m]."""

from __future__ import annotations

from semmap.nodes.sim_node.models.forms import DARK, STEEL, WHITE, column, legs, shade, slab
from semmap.nodes.sim_node.models.openings import cabinet_box, pull_out, wall_of
from semmap.nodes.sim_node.models.parts import ALONG_X, Colour, Parts, ball, box, rod, visual


def chair(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Four legs, a seat and a slatted back at -x."""
    seat, thick = 0.5 * z, 0.035
    posts = [
        box(
            (thick, thick, z - seat),
            (-(x - thick) / 2, side * (y - thick) / 2, (z + seat) / 2),
            colour,
        )
        for side in (-1, 1)
    ]
    slats = [
        box((0.02, y, 0.1 * z), (-(x - thick) / 2, 0, height * z), shade(colour, 1.15))
        for height in (0.7, 0.93)
    ]
    return [
        *legs(x, y, seat - 0.03, thick, colour),
        slab(x, y, seat - 0.03, seat, shade(colour, 1.15)),
        *posts,
        *slats,
    ]


def stool(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A round seat on four legs."""
    radius = min(x, y) / 2
    return [
        column(radius, z - 0.04, z, colour),
        *legs(1.3 * radius, 1.3 * radius, z - 0.04, 0.03, shade(colour, 0.8)),
    ]


def bench(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A long plank on two trestles, no back."""
    thick = 0.05
    trestles = [
        box((0.9 * x, 0.06, z - thick), (0, side * 0.4 * y, (z - thick) / 2), colour) for side in (-1, 1)
    ]
    return [slab(x, y, z - thick, z, shade(colour, 1.2)), *trestles]


def table(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A top on four legs, with an apron under it."""
    thick = min(0.04, z / 4)
    apron = visual(slab(0.86 * x, 0.9 * y, z - thick - min(0.07, z / 6), z - thick, shade(colour, 0.8)))
    return [
        slab(x, y, z - thick, z, colour),
        *legs(0.94 * x, 0.94 * y, z - thick, 0.06, shade(colour, 0.85)),
        *apron,
    ]


def desk(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A top on a block of drawers at one side, the first at the top, and two legs at the other."""
    thick, block = 0.035, 0.3 * y
    left = -(y - block) / 2
    case = (0.9 * x, block, z - thick)
    deep = 0.94 * (case[0] - wall_of(case))
    drawers = [
        part
        for row in range(3)
        for part in pull_out(
            f"drawer_{3 - row}",
            (deep, 0.8 * block, 0.18 * z),
            (0.45 * x - deep / 2, left, (0.17 + 0.3 * row) * z),
            colour,
            panel=(0.86 * block, 0.24 * z),
            face=visual(rod(0.012, 0.03, (0.45 * x + 0.02, left, (0.17 + 0.3 * row) * z), STEEL, ALONG_X)),
        )
    ]
    posts = [
        box((0.05, 0.05, z - thick), (side * 0.42 * x, 0.46 * y, (z - thick) / 2), DARK) for side in (-1, 1)
    ]
    return [
        slab(x, y, z - thick, z, colour),
        *cabinet_box(case, (0, left, (z - thick) / 2), shade(colour, 0.9)),
        *posts,
        *drawers,
    ]


def bed(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A mattress on a frame with a headboard at -x, a blanket and two pillows."""
    deck, lying = 0.35 * z, 0.62 * z
    pillows = [
        part
        for side in (-1, 1)
        for part in visual(ball((0.4, 0.38 * y, 0.14), (-x / 2 + 0.32, side * 0.24 * y, lying + 0.03), WHITE))
    ]
    return [
        box((x, y, 0.6 * deck), (0, 0, 0.7 * deck), colour),
        *legs(x, y, 0.4 * deck, 0.07, colour),
        box((x - 0.06, 0.97 * y, lying - deck), (0.02, 0, (deck + lying) / 2), WHITE),
        *visual(box((0.62 * x, 0.985 * y, 0.05), (0.17 * x, 0, lying - 0.01), (0.35, 0.45, 0.65))),
        box((0.05, y, z - deck), (-(x - 0.05) / 2, 0, (z + deck) / 2), colour),
        *pillows,
    ]


def couch(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A seat with cushions, a back at -x and two arms."""
    seat, arm, back = 0.5 * z, min(0.16 * y, 0.2), 0.25 * x
    places = 1 if y < 1.2 else 2 if y < 1.9 else 3
    inside = y - 2 * arm
    cushions = [
        box(
            ((x - back) * 0.98, inside / places * 0.97, 0.3 * seat),
            (back / 2, inside * ((index + 0.5) / places - 0.5), 0.85 * seat),
            shade(colour, 1.25),
        )
        for index in range(places)
    ]
    arms = [
        box((x, arm, 0.68 * z - 0.05), (0, side * (y - arm) / 2, 0.34 * z + 0.025), shade(colour, 0.9))
        for side in (-1, 1)
    ]
    return [
        slab(0.96 * x, y - 2 * arm, 0.05, 0.7 * seat, colour),
        *legs(0.9 * x, 0.9 * y, 0.05, 0.05, DARK),
        *cushions,
        box((back, inside, z - 0.5 * seat), (-(x - back) / 2, 0, (z + 0.5 * seat) / 2), colour),
        *arms,
    ]
