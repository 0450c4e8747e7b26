"""Storage furniture. Depth x, width y, height z [m]."""

from __future__ import annotations

import math

from semmap.nodes.sim_node.models.forms import (
    BRASS,
    DARK,
    STEEL,
    WHITE,
    closed_box,
    column,
    front,
    legs,
    shade,
    slab,
)
from semmap.nodes.sim_node.models.openings import SIDES, cabinet_box, pull_out, side_door, wall_of
from semmap.nodes.sim_node.models.parts import (
    ALONG_Y,
    Colour,
    Parts,
    about,
    ball,
    box,
    collision,
    product,
    rod,
    visual,
)


def counter(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A kitchen worktop over cupboard doors."""
    doors = [
        part
        for side in (-1, 0, 1)
        for part in front(0.46 * x + 0.01, 0.3 * y, 0.72 * z, (side * 0.32 * y, 0.5 * z), WHITE, deep=0.01)
    ]
    return [
        *closed_box(
            (0.92 * x, 0.98 * y, z - 0.04),
            (0, 0, (z - 0.04) / 2),
            shade(colour, 0.6),
            boards=(0.5,),
            depth=0.9,
        ),
        slab(x, y, z - 0.04, z, colour),
        *doors,
    ]


def _with_doors(x: float, y: float, z: float, colour: Colour, *, foot: float, panels: bool) -> Parts:
    leaf, tall = 0.47 * y, 0.94 * (z - foot)
    doors: Parts = []
    for side, name in SIDES:
        decor = [
            part
            for half in (0.28, 0.72)
            for part in front(
                x / 2 + 0.001,
                0.7 * leaf,
                0.36 * (z - foot),
                (side * 0.24 * y, foot + half * (z - foot)),
                shade(colour, 0.95),
                deep=0.004,
            )
        ]
        knob = visual(ball((0.03,) * 3, (x / 2 - 0.002, side * 0.03, z * 0.52), BRASS))
        doors += side_door(
            name,
            (0.012, leaf, tall),
            (x / 2 - 0.006, side * 0.24 * y, (z + foot) / 2),
            shade(colour, 1.15),
            handle=[*(decor if panels else []), *knob],
            hinge=side,
        )
    body = cabinet_box(
        (x - 0.012, y, z - foot), (-0.006, 0, (z + foot) / 2), colour, boards=_shelves(z - foot), depth=0.9
    )
    return [*body, *doors]


def _shelves(height: float) -> list[float]:
    """Return the relative heights of shelves, about 40 cm apart, with space for a clothes rail at the top."""
    count = max(1, round(height / 0.4)) - (2 if height > 1.5 else 0)
    return [index / max(2, round(height / 0.4)) for index in range(1, max(2, count))]


def cabinet(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A low box with two doors on short legs."""
    foot = 0.12 * z
    return [
        *_with_doors(x, y, z, colour, foot=foot, panels=False),
        *legs(0.9 * x, 0.9 * y, foot, 0.04, shade(colour, 0.6)),
    ]


def cupboard(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Doors below, a step back, and glass doors above."""
    low = 0.45 * z
    glass = [
        part
        for side, name in SIDES
        for part in side_door(
            f"upper_{name}",
            (0.012, 0.48 * y, 0.52 * z),
            (0.15 * x + 0.006, side * 0.245 * y, 0.725 * z),
            (0.7, 0.85, 0.9),
            hinge=side,
        )
    ]
    return [
        *_with_doors(x, y, low, colour, foot=0.0, panels=False),
        *cabinet_box(
            (0.65 * x, y, z - low),
            (-0.175 * x, 0, (z + low) / 2),
            shade(colour, 0.9),
            boards=_shelves(z - low),
            depth=0.9,
        ),
        *glass,
    ]


def closet(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A tall wardrobe with panelled doors and a cornice."""
    return [
        *_with_doors(x - 0.02, y - 0.04, z - 0.05, colour, foot=0.06, panels=True),
        slab(0.94 * x, 0.94 * y, 0.0, 0.06, shade(colour, 0.6)),
        slab(x, y, z - 0.05, z, shade(colour, 0.8)),
    ]


def drawer(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A chest of drawers, the first at the top."""
    rows = max(2, min(5, round(z / 0.25)))
    pitch = 0.94 * z / rows
    case = (x - 0.032, y, z)
    wall = wall_of(case)
    pulled: Parts = []
    for row in range(rows):
        height = 0.04 * z + pitch * (row + 0.5)
        pulled += pull_out(
            f"drawer_{rows - row}",
            (0.94 * (case[0] - wall), 0.9 * y, 0.7 * pitch),
            (x / 2 - 0.032 - 0.47 * (case[0] - wall), 0, height),
            colour,
            panel=(0.92 * y, 0.86 * pitch),
            face=visual(box((0.02, 0.3 * y, 0.02), (x / 2 - 0.01, 0, height), STEEL)),
        )
    body = cabinet_box(case, (-0.016, 0, z / 2), colour)
    return [*body, *pulled]


def bedstand(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A small table with one drawer and an open shelf."""
    deck = 0.03
    panel = front(x / 2, 0.86 * y, 0.26 * z, (0, 0.78 * z), shade(colour, 1.2), deep=0.012)
    knob = visual(ball((0.03,) * 3, (x / 2 - 0.002, 0, 0.78 * z), BRASS))
    return [
        *closed_box((x - 0.012, y, 0.4 * z), (-0.006, 0, 0.8 * z), colour),
        *legs(x - 0.02, y, 0.6 * z, 0.035, shade(colour, 0.8)),
        box((0.9 * x, 0.9 * y, deck), (0, 0, 0.15 * z), colour),
        *panel,
        *knob,
    ]


def bookshelf(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Open shelves between two sides and a back."""
    thick, gaps = 0.025, max(2, min(6, round(z / 0.36)))
    inside = y - 2 * thick
    shelves = [
        box((x - 0.012, inside, thick), (0.006, 0, thick / 2 + (z - thick) * row / gaps), shade(colour, 1.15))
        for row in range(gaps + 1)
    ]
    sides = [box((x, thick, z), (0, side * (y - thick) / 2, z / 2), colour) for side in (-1, 1)]
    back = box((0.012, inside, z), (-x / 2 + 0.006, 0, z / 2), shade(colour, 0.7))
    return [*shelves, *sides, back]


def shelf(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A board with two brackets, to hang on a wall."""
    brackets = [box((0.8 * x, 0.02, 0.6 * z), (0, side * 0.35 * y, 0.3 * z), STEEL) for side in (-1, 1)]
    return [slab(x, y, 0.6 * z, z, colour), *brackets]


def clothes_rack(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A drying rack: two crossed frames and lines between them."""
    lean = 0.42 * x
    angle = math.atan2(2 * lean, z)
    length = math.hypot(2 * lean, z) * 0.98
    frames = [
        box((0.02, 0.02, length), (0, side * 0.48 * y, z / 2), colour, about("y", turn * angle))
        for side in (-1, 1)
        for turn in (-1, 1)
    ]
    lines = visual(
        rod(0.006, 0.96 * y, (offset * x, 0, 0.985 * z), STEEL, ALONG_Y)
        for offset in (-0.4, -0.2, 0, 0.2, 0.4)
    )
    feet = collision(rod(0.012, 0.98 * y, (side * lean, 0, 0.012), colour, ALONG_Y) for side in (-1, 1))
    rails = [box((x, 0.02, 0.02), (0, side * 0.48 * y, z - 0.01), colour) for side in (-1, 1)]
    return [*frames, *lines, *feet, *rails]


def coat_rack(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A pole on four feet with a crown of pegs and a coat."""
    spread = [box((x, 0.04, 0.03), (0, 0, 0.015), colour), box((0.04, y, 0.03), (0, 0, 0.015), colour)]
    pegs = visual(
        rod(
            0.009,
            0.22,
            (0.09 * math.cos(a), 0.09 * math.sin(a), z - 0.06),
            colour,
            product(about("z", a), about("y", 1.0)),
        )
        for a in (i * math.pi / 3 for i in range(6))
    )
    coat = visual(ball((0.16, 0.30, 0.42 * z), (0.12, 0, 0.68 * z), (0.30, 0.36, 0.30)))
    return [*spread, column(0.022, 0.03, z, colour), *pegs, *coat]


def shoe_rack(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Two slanting shelves between sides, with shoes on them."""
    sides = [box((x, 0.02, z), (0, side * (y - 0.02) / 2, z / 2), colour) for side in (-1, 1)]
    decks = [box((x, y - 0.04, 0.02), (0, 0, height * z), shade(colour, 1.2)) for height in (0.12, 0.55)]
    pairs = visual(
        ball((0.75 * x, 0.09, 0.10), (0, y * k, (height + 0.12) * z), tone)
        for height in (0.12, 0.55)
        for k, tone in ((-0.32, DARK), (-0.17, DARK), (0.1, (0.6, 0.2, 0.2)), (0.25, (0.6, 0.2, 0.2)))
    )
    return [*sides, *decks, *pairs, slab(x, y, 0.97 * z, z, colour)]
