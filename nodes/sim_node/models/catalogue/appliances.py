"""Household appliances. Depth x, width y, height z [m]; the front is at +x."""

from __future__ import annotations

import math
from collections.abc import Sequence

from semmap.nodes.sim_node.models.forms import (
    BLACK,
    DARK,
    GREY,
    LIGHT,
    SCREEN,
    STEEL,
    closed_box,
    column,
    front,
    shade,
    slab,
    solid,
    turned,
)
from semmap.nodes.sim_node.models.openings import WIDE, cabinet_box, flap, framed_box, side_door
from semmap.nodes.sim_node.models.parts import (
    ALONG_X,
    ALONG_Y,
    Colour,
    Joint,
    Parts,
    Vec3,
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


def case(
    x: float,
    y: float,
    z: float,
    colour: Colour,
    *,
    deep: float,
    boards: Sequence[float] = (),
    depth: float = 1.0,
) -> Parts:
    """The body of an appliance, with room in it, that leaves room for a front of depth `deep`."""
    return closed_box((x - deep, y, z), (-deep / 2, 0, z / 2), colour, boards=boards, depth=depth)


def knobs(x: float, y: float, height: float, count: int, radius: float) -> Parts:
    """A row of knobs on a front."""
    return visual(
        rod(radius, 0.02, (x / 2 - 0.01, y * ((i + 0.5) / count - 0.5), height), BLACK, ALONG_X)
        for i in range(count)
    )


def fridge(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A freezer door above a tall door, each with an upright handle."""
    split, deep = 0.68 * z, 0.07 * x
    body = shade(colour, 0.9)
    rooms = [
        *cabinet_box(
            (x - deep, y, split), (-deep / 2, 0, split / 2), body, boards=(0.3, 0.5, 0.7), depth=0.85
        ),
        *cabinet_box((x - deep, y, z - split), (-deep / 2, 0, (z + split) / 2), body),
    ]
    return [
        *rooms,
        *side_door(
            "door",
            (deep - 0.02, 0.98 * y, split - 0.02),
            (x / 2 - 0.02 - (deep - 0.02) / 2, 0, split / 2 + 0.01),
            colour,
            handle=box((0.02, 0.025, 0.3 * split), (x / 2 - 0.01, -0.42 * y, 0.75 * split), STEEL),
        ),
        *side_door(
            "freezer",
            (deep - 0.02, 0.98 * y, z - split - 0.02),
            (x / 2 - 0.02 - (deep - 0.02) / 2, 0, (z + split) / 2),
            colour,
            handle=box((0.02, 0.025, 0.18 * z), (x / 2 - 0.01, -0.42 * y, split + 0.16 * z), STEEL),
        ),
    ]


def oven(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Hobs on top, a row of knobs, a dark glass door with a rail."""
    hobs = visual(
        rod(0.11 * y * (1 + 0.25 * i), 0.012, (0.22 * x * i, 0.23 * y * j, z - 0.006), DARK)
        for i in (-1, 1)
        for j in (-1, 1)
    )
    hole = (-0.4 * y, 0.4 * y, 0.2 * z, 0.7 * z)
    glass = box((0.02, 0.86 * y, 0.55 * z), (x / 2 - 0.03, 0, 0.45 * z), SCREEN)
    rail = visual(rod(0.012, 0.76 * y, (x / 2 - 0.012, 0, 0.69 * z), STEEL, ALONG_Y))
    return [
        *framed_box(
            (x - 0.04, y, z - 0.006), (-0.02, 0, (z - 0.006) / 2), colour, hole, boards=(0.4,), depth=0.9
        ),
        *knobs(x, 0.8 * y, 0.9 * z, 5, 0.022),
        *flap("door", [glass, *rail], (x / 2 - 0.02, 0.0, 0.175 * z)),
        *hobs,
    ]


def stove(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A hob let into a worktop: four burners under iron grates."""
    deck = 0.5 * z
    burners = [(0.24 * x * i, 0.24 * y * j) for i in (-1, 1) for j in (-1, 1)]
    return [
        slab(x, y, 0, deck, colour),
        *visual(rod(0.13 * y, 0.6 * deck, (px, py, 1.15 * deck), BLACK) for px, py in burners),
        *visual(rod(0.06 * y, deck, (px, py, 1.3 * deck), GREY) for px, py in burners),
        *visual(box((0.4 * x, 0.012, 0.2 * deck), (px, py, 0.93 * z), DARK) for px, py in burners),
        *visual(box((0.012, 0.4 * y, 0.2 * deck), (px, py, 0.93 * z), DARK) for px, py in burners),
        *visual(
            rod(0.025, 0.3 * deck, (0.46 * x, 0.1 * y * i, 1.15 * deck), STEEL)
            for i in (-1.5, -0.5, 0.5, 1.5)
        ),
        *solid(0.9 * x, 0.9 * y, deck, z),
    ]


def dishwasher(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A plain door with a control strip and a rail."""
    hole = (-0.46 * y, 0.46 * y, 0.1 * z, 0.94 * z)
    door = [
        box((0.03, 0.97 * y, 0.74 * z), (x / 2 - 0.035, 0, 0.45 * z), colour),
        *visual(box((0.03, 0.97 * y, 0.12 * z), (x / 2 - 0.035, 0, 0.91 * z), DARK)),
        *collision(box((0.03, 0.97 * y, 0.15 * z), (x / 2 - 0.035, 0, 0.895 * z), DARK)),
        *visual(box((0.02, 0.7 * y, 0.025), (x / 2 - 0.01, 0, 0.78 * z), STEEL)),
        *visual(
            box((0.004, 0.05 * y, 0.02), (x / 2 - 0.016, y * i, 0.91 * z), (0.3, 0.9, 0.4))
            for i in (0.2, 0.3)
        ),
    ]
    return [
        *framed_box(
            (x - 0.05, y, z), (-0.025, 0, z / 2), shade(colour, 0.85), hole, boards=(0.5,), depth=0.9
        ),
        *flap("door", door, (x / 2 - 0.02, 0.0, 0.08 * z)),
    ]


def washing_machine(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A round porthole under a control strip."""
    porthole = 0.3 * y
    half, middle = 0.85 * porthole, 0.45 * z
    ring = rod(1.15 * porthole, 0.02, (x / 2 - 0.03, 0, middle), STEEL, ALONG_X)
    joint = Joint(
        name="door",
        kind="hinge",
        anchor=(x / 2 - 0.02, -1.15 * porthole, middle),
        axis=(0.0, 0.0, -1.0),
        range=(0.0, WIDE),
    )
    return [
        *framed_box((x - 0.04, y, z), (-0.02, 0, z / 2), colour, (-half, half, middle - half, middle + half)),
        *moving(
            joint,
            [ring, *visual(ball((0.05, 1.9 * porthole, 1.9 * porthole), (x / 2 - 0.03, 0, middle), SCREEN))],
        ),
        *front(x / 2 - 0.03, 0.96 * y, 0.13 * z, (0, 0.91 * z), shade(colour, 0.75), deep=0.01),
        *visual(rod(0.045, 0.03, (x / 2 - 0.02, 0.25 * y, 0.91 * z), STEEL, ALONG_X)),
        *front(x / 2 - 0.025, 0.25 * y, 0.08 * z, (-0.3 * y, 0.91 * z), LIGHT, deep=0.01),
    ]


def microwave(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A wide dark window, and buttons at the right."""
    buttons = visual(
        box((0.008, 0.03, 0.12 * z), (x / 2 - 0.012, 0.40 * y + 0.022 * side, (0.2 + 0.18 * row) * z), GREY)
        for row in range(3)
        for side in (-1, 1)
    )
    handle = visual(box((0.02, 0.02, 0.7 * z), (x / 2 - 0.01, 0.24 * y, 0.5 * z), STEEL))
    return [
        *framed_box((x - 0.02, y, z), (-0.01, 0, z / 2), colour, (-0.45 * y, 0.2 * y, 0.12 * z, 0.88 * z)),
        *side_door(
            "door",
            (0.01, 0.68 * y, 0.82 * z),
            (x / 2 - 0.015, -0.13 * y, 0.5 * z),
            SCREEN,
            handle=handle,
            hinge=-1,
        ),
        *front(x / 2 - 0.01, 0.17 * y, 0.18 * z, (0.4 * y, 0.8 * z), (0.1, 0.5, 0.3), deep=0.01),
        *buttons,
    ]


def kettle(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A tapering body with a lid, a spout towards +y and a handle behind."""
    radius = min(x / 2, 0.33 * y)
    body = turned([(radius, 0.06 * z), (0.72 * radius, 0.85 * z)], colour, steps=8)
    grip = -(radius + 0.06 * y)
    return [
        column(0.95 * radius, 0, 0.06 * z, BLACK),
        *body,
        *collision(with_cavity(column(0.86 * radius, 0.06 * z, 0.85 * z, colour), is_open=False)),
        *visual(column(0.7 * radius, 0.85 * z, 0.92 * z, BLACK)),
        *visual(ball((0.03, 0.03, 0.1 * z), (0, 0, 0.95 * z), BLACK)),
        *visual(box((0.25 * radius, 0.5 * radius, 0.09 * z), (0, radius, 0.72 * z), colour, about("x", 0.7))),
        *visual(pill(0.014, 0.62 * z, (0, grip, 0.5 * z), BLACK)),
        *visual(
            box((0.025, 0.5 * radius, 0.03), (0, grip + 0.2 * radius, h * z), BLACK) for h in (0.23, 0.78)
        ),
    ]


def toaster(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Two slots with bread, a lever at the end."""
    return [
        slab(x, 0.94 * y, 0.04 * z, 0.88 * z, colour),
        *collision(slab(0.9 * x, 0.85 * y, 0, 0.04 * z, BLACK)),
        *visual(slab(0.85 * x, 0.85 * y, 0, 0.06 * z, BLACK)),
        *visual(box((0.14 * x, 0.7 * y, 0.02), (0.2 * x * s, 0, 0.875 * z), BLACK) for s in (-1, 1)),
        *visual(
            box((0.09 * x, 0.5 * y, 0.3 * z), (0.2 * x * s, 0, 0.85 * z), (0.85, 0.62, 0.32)) for s in (-1, 1)
        ),
        *visual(box((0.2 * x, 0.05 * y, 0.08 * z), (0, 0.475 * y, 0.6 * z), BLACK)),
    ]


def coffee_machine(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A tower with a brewing head over a glass jug."""
    back = 0.4 * x
    jug = min(0.26 * x, 0.4 * y)
    place: Vec3 = (0.17 * x, 0, 0.08 * z + 0.19 * z)
    return [
        slab(x, y, 0, 0.08 * z, colour),
        box((back, y, 0.7 * z), (-(x - back) / 2, 0, 0.43 * z), colour),
        slab(x, y, 0.74 * z, z, shade(colour, 1.3)),
        rod(jug, 0.38 * z, place, (0.25, 0.15, 0.1)),
        *visual(rod(0.8 * jug, 0.05 * z, (place[0], 0, 0.5 * z), BLACK)),
        *visual(box((0.02, 0.02, 0.24 * z), (x / 2 - 0.01, 0, 0.3 * z), BLACK)),
        *visual(rod(0.5 * jug, 0.08 * z, (place[0], 0, 0.7 * z), BLACK)),
        *visual(box((0.006, 0.1, 0.04), (x / 2, 0, 0.88 * z), (0.4, 0.8, 0.5))),
    ]


def boiler(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A tank on the wall, rounded above and below, with pipes and a dial."""
    radius = min(x, y) / 2
    return [
        *visual(column(radius, 0.22 * z, 0.88 * z, colour)),
        *collision(column(radius, 0, z, colour)),
        *visual(ball((2 * radius, 2 * radius, 0.24 * z), (0, 0, h * z), colour) for h in (0.22, 0.88)),
        *visual(
            rod(0.012, 0.14 * z, (0, 0.3 * radius * s, 0.07 * z), c)
            for s, c in ((-1, (0.7, 0.2, 0.2)), (1, STEEL))
        ),
        *visual(rod(0.25 * radius, 0.02, (radius, 0, 0.36 * z), DARK, ALONG_X)),
    ]


def hood(x: float, y: float, z: float, colour: Colour) -> Parts:
    """An extractor hood: a rim, a canopy that narrows, and a chimney at the wall."""
    rim, canopy, steps = 0.1 * z, 0.4 * z, 14
    thick = (canopy - rim) / steps
    layers = [
        box(
            (x * (1 - 0.65 * i / steps), y * (1 - 0.62 * i / steps), thick),
            (-0.325 * x * i / steps, 0, rim + thick * (i - 0.5)),
            colour,
        )
        for i in range(1, steps + 1)
    ]
    return [
        slab(x, y, 0, rim, shade(colour, 0.8)),
        *layers,
        box((0.33 * x, 0.36 * y, z - canopy), (-0.335 * x, 0, (z + canopy) / 2), colour),
    ]


def iron(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A pointed sole towards +y, with a handle above."""
    sole = 0.1 * z
    return [
        *visual(box((x, 0.6 * y, sole), (0, -0.2 * y, sole / 2), STEEL)),
        *collision(slab(0.8 * x, 0.9 * y, 0, sole, STEEL)),
        *visual(ball((x, 0.78 * y, 1.6 * sole), (0, 0.11 * y, 0.8 * sole), STEEL)),
        *visual(ball((0.85 * x, 0.7 * y, 0.7 * z), (0, -0.05 * y, 0.36 * z), colour)),
        *visual(box((0.7 * x, 0.4 * y, 0.4 * z), (0, -0.28 * y, 0.3 * z), colour)),
        *visual(box((0.25 * x, 0.6 * y, 0.14 * z), (0, -0.1 * y, 0.93 * z), DARK)),
        *visual(
            box((0.25 * x, 0.1 * y, 0.5 * z), (0, 0.19 * y * s - 0.12 * y, 0.7 * z), DARK) for s in (-1, 1)
        ),
        *collision(box((0.6 * x, 0.6 * y, z - sole), (0, -0.15 * y, (z + sole) / 2), DARK)),
    ]


def vacuum_cleaner(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A drum on wheels, with a hose and a tube that stands up."""
    drum = 0.34 * z
    return [
        rod(drum / 2, 0.55 * x, (-0.2 * x, 0, 0.55 * drum), colour, ALONG_X),
        *visual(rod(0.4 * drum, 0.06, (-0.3 * x, 0.45 * y * s, 0.4 * drum), DARK, ALONG_Y) for s in (-1, 1)),
        *visual(ball((0.5 * drum,) * 3, (0.08 * x, 0, 0.6 * drum), DARK)),
        *visual(rod(0.016, 0.98 * z, (0.32 * x, 0, 0.5 * z), STEEL, about("y", -0.12))),
        *visual(pill(0.02, 0.72 * z, (0.14 * x, 0, 0.63 * z), BLACK, about("y", 0.32))),  # the hose
        *visual(box((0.12, 0.9 * y, 0.04), (0.4 * x, 0, 0.02), DARK)),
        *solid(0.95 * x, 0.9 * y, 0, 0.1 * z),
    ]


def fan(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A standing fan: foot, stem, and blades in a cage facing +x."""
    radius = min(y / 2, 0.3 * z)
    hub: Vec3 = (0, 0, z - radius)
    blades = visual(
        box((0.02, 0.35 * radius, 1.6 * radius), hub, shade(colour, 1.2), about("x", i * 1.047))
        for i in range(3)
    )
    angles = [i * math.pi / 6 for i in range(12)]
    rim = visual(
        box(
            (0.22 * x, 0.53 * radius, 0.012),
            (0, 0.96 * radius * math.sin(angle), hub[2] + 0.96 * radius * math.cos(angle)),
            STEEL,
            about("x", -angle),
        )
        for angle in angles
    )
    return [
        column(0.45 * min(x, y), 0, 0.02, DARK),
        column(0.02, 0.02, z - radius, GREY),
        *blades,
        *rim,
        *visual(ball((0.4 * x, 0.3 * radius, 0.3 * radius), hub, colour)),
        *collision(rod(radius, 0.3 * x, hub, STEEL, ALONG_X)),
    ]


def heater(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A radiator of upright ribs."""
    ribs = max(4, min(14, round(y / 0.07)))
    pitch = y / ribs
    return [
        *visual(box((x, 0.7 * pitch, z), (0, pitch * (i + 0.5) - y / 2, z / 2), colour) for i in range(ribs)),
        *collision(slab(x, 0.97 * y, 0, z, colour)),
        *visual(rod(0.2 * x, 0.98 * y, (0, 0, h * z), shade(colour, 0.8), ALONG_Y) for h in (0.1, 0.9)),
    ]


def air_conditioner(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A long white box on a wall, with a slot below."""
    return [
        box((x - 0.02, y, z), (-0.01, 0, z / 2), colour),
        *front(x / 2, 0.98 * y, 0.62 * z, (0, 0.66 * z), shade(colour, 1.1), deep=0.02),
        *visual(box((0.03, 0.85 * y, 0.03), (x / 2 - 0.02, 0, h * z), DARK) for h in (0.12, 0.24)),
        *visual(box((0.006, 0.02, 0.02), (x / 2, 0.4 * y, 0.5 * z), (0.2, 0.8, 0.3))),
    ]
