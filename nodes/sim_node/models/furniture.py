"""Furniture: what stands on the floor and carries or holds things. Depth x, width y, height z [m]."""

from __future__ import annotations

import math

from nodes.sim_node.models.forms import (
    BLACK,
    BRASS,
    DARK,
    GREY,
    PAPER,
    STEEL,
    WHITE,
    column,
    front,
    legs,
    shade,
    slab,
    turned,
)
from nodes.sim_node.models.parts import (
    ALONG_X,
    ALONG_Y,
    Colour,
    Parts,
    about,
    ball,
    box,
    felt,
    pill,
    product,
    rod,
    seen,
)


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
    apron = seen(slab(0.86 * x, 0.9 * y, z - thick - min(0.07, z / 6), z - thick, shade(colour, 0.8)))
    return [
        slab(x, y, z - thick, z, colour),
        *legs(0.94 * x, 0.94 * y, z - thick, 0.06, shade(colour, 0.85)),
        *apron,
    ]


def desk(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A top on a drawer block at one side and two legs at the other."""
    thick, block = 0.035, 0.3 * y
    left = -(y - block) / 2
    drawers = [
        part
        for row in range(3)
        for part in front(
            0.45 * x + 0.012,
            0.86 * block,
            0.24 * z,
            (left, (0.17 + 0.3 * row) * z),
            shade(colour, 1.25),
            deep=0.012,
        )
    ]
    knobs = [
        part
        for row in range(3)
        for part in seen(rod(0.012, 0.03, (0.45 * x + 0.02, left, (0.17 + 0.3 * row) * z), STEEL, ALONG_X))
    ]
    posts = [
        box((0.05, 0.05, z - thick), (side * 0.42 * x, 0.46 * y, (z - thick) / 2), DARK) for side in (-1, 1)
    ]
    return [
        slab(x, y, z - thick, z, colour),
        box((0.9 * x, block, z - thick), (0, left, (z - thick) / 2), shade(colour, 0.9)),
        *posts,
        *drawers,
        *knobs,
    ]


def counter(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A kitchen worktop over cupboard doors."""
    doors = [
        part
        for side in (-1, 0, 1)
        for part in front(0.46 * x + 0.01, 0.3 * y, 0.72 * z, (side * 0.32 * y, 0.5 * z), WHITE, deep=0.01)
    ]
    return [
        box((0.92 * x, 0.98 * y, z - 0.04), (0, 0, (z - 0.04) / 2), shade(colour, 0.6)),
        slab(x, y, z - 0.04, z, colour),
        *doors,
    ]


def _with_doors(x: float, y: float, z: float, colour: Colour, *, foot: float, panels: bool) -> Parts:
    leaf = 0.47 * y
    doors = [
        part
        for side in (-1, 1)
        for part in front(
            x / 2, leaf, 0.94 * (z - foot), (side * 0.24 * y, (z + foot) / 2), shade(colour, 1.15), deep=0.012
        )
    ]
    inner = [
        part
        for side in (-1, 1)
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
    knobs = [
        part
        for side in (-1, 1)
        for part in seen(ball((0.03,) * 3, (x / 2 - 0.002, side * 0.03, z * 0.52), BRASS))
    ]
    body = box((x - 0.012, y, z - foot), (-0.006, 0, (z + foot) / 2), colour)
    return [body, *doors, *(inner if panels else []), *knobs]


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
        for side in (-1, 1)
        for part in front(
            0.15 * x + 0.012, 0.42 * y, 0.44 * z, (side * 0.23 * y, 0.74 * z), (0.7, 0.85, 0.9), deep=0.012
        )
    ]
    return [
        *_with_doors(x, y, low, colour, foot=0.0, panels=False),
        box((0.65 * x, y, z - low), (-0.175 * x, 0, (z + low) / 2), shade(colour, 0.9)),
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
    """A chest of drawers."""
    rows = max(2, min(5, round(z / 0.25)))
    pitch = 0.94 * z / rows
    fronts, handles = [], []
    for row in range(rows):
        height = 0.04 * z + pitch * (row + 0.5)
        fronts += front(x / 2 - 0.02, 0.92 * y, 0.86 * pitch, (0, height), shade(colour, 1.2), deep=0.012)
        handles += seen(box((0.02, 0.3 * y, 0.02), (x / 2 - 0.01, 0, height), STEEL))
    return [box((x - 0.032, y, z), (-0.016, 0, z / 2), colour), *fronts, *handles]


def bedstand(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A small table with one drawer and an open shelf."""
    deck = 0.03
    panel = front(x / 2, 0.86 * y, 0.26 * z, (0, 0.78 * z), shade(colour, 1.2), deep=0.012)
    knob = seen(ball((0.03,) * 3, (x / 2 - 0.002, 0, 0.78 * z), BRASS))
    return [
        box((x - 0.012, y, 0.4 * z), (-0.006, 0, 0.8 * z), colour),
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


def bed(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A mattress on a frame with a headboard at -x, a blanket and two pillows."""
    deck, lying = 0.35 * z, 0.62 * z
    pillows = [
        part
        for side in (-1, 1)
        for part in seen(ball((0.4, 0.38 * y, 0.14), (-x / 2 + 0.32, side * 0.24 * y, lying + 0.03), WHITE))
    ]
    return [
        box((x, y, 0.6 * deck), (0, 0, 0.7 * deck), colour),
        *legs(x, y, 0.4 * deck, 0.07, colour),
        box((x - 0.06, 0.97 * y, lying - deck), (0.02, 0, (deck + lying) / 2), WHITE),
        *seen(box((0.62 * x, 0.985 * y, 0.05), (0.17 * x, 0, lying - 0.01), (0.35, 0.45, 0.65))),
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


def board(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A white board in a frame: a curve in blue, lines in red, and a tray with pens and a sponge."""
    face, ink = 0.111 * x, 0.014 * z
    blue, red = (0.15, 0.30, 0.75), (0.80, 0.15, 0.15)
    curve = [
        ball(
            (0.004, 0.09 * y, ink),
            (face, (-0.38 + 0.05 * i) * y, (0.62 + 0.05 * math.sin(0.8 * i)) * z),
            blue,
        )
        for i in range(9)
    ]
    lines = [
        box((0.003, width * y, ink), (face, (0.10 + width / 2) * y, (0.82 - 0.09 * i) * z), red)
        for i, width in enumerate((0.32, 0.26, 0.30, 0.16))
    ]
    pens = [
        rod(0.010, 0.12, (0.25 * x, (-0.18 + 0.12 * i) * y, 0.042), pen, ALONG_Y)
        for i, pen in enumerate((blue, red, BLACK))
    ]
    return [
        box((0.6 * x, y, z), (-0.2 * x, 0, z / 2), colour),
        *seen(box((0.02 * x + 0.002, 0.95 * y, 0.92 * z), (0.1 * x, 0, 0.5 * z), WHITE)),
        *seen([*curve, *lines, *pens]),
        *seen(box((0.9 * x, 0.5 * y, 0.02), (0.05 * x, 0, 0.02), GREY)),
        *seen(box((0.03, 0.10, 0.03), (0.25 * x, 0.2 * y, 0.045), (0.95, 0.80, 0.25))),
    ]


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
    lines = seen(
        rod(0.006, 0.96 * y, (offset * x, 0, 0.985 * z), STEEL, ALONG_Y)
        for offset in (-0.4, -0.2, 0, 0.2, 0.4)
    )
    feet = felt(rod(0.012, 0.98 * y, (side * lean, 0, 0.012), colour, ALONG_Y) for side in (-1, 1))
    rails = [box((x, 0.02, 0.02), (0, side * 0.48 * y, z - 0.01), colour) for side in (-1, 1)]
    return [*frames, *lines, *feet, *rails]


def lamp(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A standing or table lamp: foot, stem and a conical shade."""
    radius = min(x, y) / 2
    foot = 0.03 * z + 0.01
    shade_low = 0.68 * z
    return [
        column(0.8 * radius, 0, foot, DARK),
        column(max(0.05 * radius, 0.008), foot, z - 0.02, BRASS),
        *turned([(radius, shade_low), (0.6 * radius, z)], colour, steps=10),
        *felt(column(0.85 * radius, shade_low, z, colour)),
    ]


def hanging_lamp(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A pendant: a bowl of light on a wire, to hang from a ceiling."""
    radius = min(x, y) / 2
    return [
        *turned([(radius, 0.0), (0.25 * radius, 0.45 * z)], colour, steps=8),
        *felt(column(0.8 * radius, 0, 0.45 * z, colour)),
        *seen(ball((0.5 * radius, 0.5 * radius, 0.2 * z), (0, 0, 0.1 * z), (1.0, 0.95, 0.7))),
        *seen(column(0.012, 0.45 * z, z, DARK)),
    ]


def clock(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A round wall clock facing +x."""
    radius = min(y, z) / 2
    return [
        rod(radius, 0.9 * x, (-0.05 * x, 0, z / 2), colour, ALONG_X),
        *seen(rod(0.88 * radius, 0.05 * x, (0.42 * x, 0, z / 2), PAPER, ALONG_X)),
        *seen(box((0.05 * x, 0.05 * radius, 0.7 * radius), (0.47 * x, 0, z / 2 + 0.3 * radius), BLACK)),
        *seen(box((0.05 * x, 0.5 * radius, 0.06 * radius), (0.47 * x, 0.22 * radius, z / 2), BLACK)),
    ]


def toilet_roll(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A standing roll with a dark core."""
    radius = min(x, y) / 2
    return [column(radius, 0, z, colour), *seen(column(0.4 * radius, 0.5 * z, z + 0.001, (0.55, 0.45, 0.35)))]


def pillow(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Soft: high in the middle, with a round border."""
    radius, border = 0.3 * z, shade(colour, 0.92)
    edges = [
        *(pill(radius, x, (0, (y / 2 - radius) * s, z / 2), border, ALONG_X) for s in (-1, 1)),
        *(pill(radius, y, ((x / 2 - radius) * s, 0, z / 2), border, ALONG_Y) for s in (-1, 1)),
    ]
    inside = [
        box((x - 2 * radius, y - 2 * radius, 2 * radius), (0, 0, z / 2), border),
        ball((0.96 * x, 0.96 * y, 0.96 * z), (0, 0, z / 2), colour),
    ]
    return [*seen([*edges, *inside]), *felt(box((0.9 * x, 0.9 * y, z), (0, 0, z / 2), colour))]


def cushion(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A pillow that a button holds together."""
    return [
        *pillow(x, y, z, colour),
        *seen(ball((0.09 * x, 0.09 * x, 0.08 * z), (0, 0, 0.96 * z), shade(colour, 0.6))),
    ]


def rug(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A flat rug with a border."""
    return [slab(x, y, 0, z, colour), *seen(slab(0.86 * x, 0.9 * y, 0.5 * z, z + 0.001, shade(colour, 1.4)))]


def figure(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A person of capsules, facing +x; it collides as one upright box on its soles."""
    skin: Colour = (0.85, 0.65, 0.52)
    shoulder, hip, head = 0.82 * z, 0.48 * z, 0.13 * z
    torso_radius = 0.3 * y
    limbs = []
    for side in (-1, 1):
        limbs += seen(pill(0.17 * y, hip, (0, side * 0.19 * y, hip / 2), (0.2, 0.25, 0.4)))
        limbs += seen(
            pill(
                0.11 * y, 0.42 * z, (0, side * 0.39 * y, shoulder - 0.19 * z), skin, about("x", side * -0.12)
            )
        )
        limbs += seen(box((0.9 * x, 0.24 * y, 0.05 * z), (0.02, side * 0.19 * y, 0.025 * z), DARK))
    return [
        *limbs,
        *seen(pill(torso_radius, shoulder - hip + 0.12 * z, (0, 0, (shoulder + hip) / 2), colour)),
        *seen(pill(0.09 * y, 0.12 * z, (0, 0, 0.85 * z), skin)),
        *seen(ball((0.11 * z, 0.1 * z, head), (0, 0, z - head / 2), skin)),
        *seen(ball((0.115 * z, 0.105 * z, 0.07 * z), (-0.008, 0, z - 0.034 * z), (0.25, 0.17, 0.1))),
        *felt(box((0.8 * x, 0.9 * y, z), (0.02, 0, z / 2), colour)),
    ]


def coat_rack(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A pole on four feet with a crown of pegs and a coat."""
    spread = [box((x, 0.04, 0.03), (0, 0, 0.015), colour), box((0.04, y, 0.03), (0, 0, 0.015), colour)]
    pegs = seen(
        rod(
            0.009,
            0.22,
            (0.09 * math.cos(a), 0.09 * math.sin(a), z - 0.06),
            colour,
            product(about("z", a), about("y", 1.0)),
        )
        for a in (i * math.pi / 3 for i in range(6))
    )
    coat = seen(ball((0.16, 0.30, 0.42 * z), (0.12, 0, 0.68 * z), (0.30, 0.36, 0.30)))
    return [*spread, column(0.022, 0.03, z, colour), *pegs, *coat]


def shoe_rack(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Two slanting shelves between sides, with shoes on them."""
    sides = [box((x, 0.02, z), (0, side * (y - 0.02) / 2, z / 2), colour) for side in (-1, 1)]
    decks = [box((x, y - 0.04, 0.02), (0, 0, height * z), shade(colour, 1.2)) for height in (0.12, 0.55)]
    pairs = seen(
        ball((0.75 * x, 0.09, 0.10), (0, y * k, (height + 0.12) * z), tone)
        for height in (0.12, 0.55)
        for k, tone in ((-0.32, DARK), (-0.17, DARK), (0.1, (0.6, 0.2, 0.2)), (0.25, (0.6, 0.2, 0.2)))
    )
    return [*sides, *decks, *pairs, slab(x, y, 0.97 * z, z, colour)]
