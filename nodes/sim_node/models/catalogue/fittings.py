"""Parts of a building and fittings. Depth x, width y, height z [m]; the front is at +x."""

from __future__ import annotations

import math

from semmap.nodes.sim_node.models.forms import (
    BLACK,
    BRASS,
    DARK,
    GLASSY,
    PAPER,
    STEEL,
    WHITE,
    hollow_box,
    shade,
    shifted,
    slab,
)
from semmap.nodes.sim_node.models.openings import GAP_M, side_door
from semmap.nodes.sim_node.models.parts import (
    ALONG_X,
    ALONG_Y,
    Colour,
    Parts,
    about,
    ball,
    box,
    collision,
    rod,
    visual,
    with_cavity,
)


def wall(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A slab with a skirting board."""
    return [slab(x, y, 0, z, colour), *visual(slab(x + 0.012, y, 0, min(0.08, z / 10), shade(colour, 0.7)))]


def door(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A leaf with two panels and handles, in a frame."""
    jamb = min(0.06, y / 10)
    panels = visual(
        box((0.75 * x, 0.6 * y, 0.34 * z), (0, 0, height * z), shade(colour, 0.85)) for height in (0.28, 0.70)
    )
    handles = visual(
        rod(0.2 * x, 0.12, (side * 0.38 * x, 0.36 * y, 0.49 * z), STEEL, ALONG_Y) for side in (-1, 1)
    )
    jambs = [box((x, jamb, z), (0, side * (y - jamb) / 2, z / 2), shade(colour, 1.25)) for side in (-1, 1)]
    lintel = box((x, y - 2 * jamb, jamb), (0, 0, z - jamb / 2), shade(colour, 1.25))
    leaf = side_door(
        "leaf",
        (0.6 * x, y - 2 * jamb - 2 * GAP_M, z - jamb - 0.01),
        (0.0, 0.0, (z - jamb) / 2 + 0.003),
        colour,
        handle=[*panels, *handles],
        hinge=-1,
    )
    return [*leaf, *jambs, lintel]


def window(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Four panes in a frame, on a sill."""
    bar = min(0.06, y / 8)
    pane = box((0.3 * x, y - bar, z - bar), (0, 0, z / 2), GLASSY)
    uprights = [box((0.7 * x, bar, z), (0, side * (y - bar) / 2, z / 2), colour) for side in (-1, 0, 1)]
    rails = [box((0.7 * x, y, bar), (0, 0, height), colour) for height in (bar / 2, z / 2, z - bar / 2)]
    sill = visual(box((x + 0.012, y, 0.04), (0, 0, 0.02), shade(colour, 0.85)))
    return [pane, *uprights, *rails, *sill]


def blinds(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Slats under a head rail."""
    count = max(6, min(24, round(z / 0.06)))
    pitch = 0.94 * z / count
    return [
        *visual(
            box((x, y, 0.45 * pitch), (0, 0, pitch * (i + 0.5)), colour, about("y", 0.4))
            for i in range(count)
        ),
        box((x, y, 0.06 * z), (0, 0, 0.97 * z), shade(colour, 0.8)),
        *collision(slab(0.6 * x, y, 0, 0.94 * z, colour)),
    ]


def curtain(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Folds that hang from a rod."""
    count = max(6, min(28, math.ceil(y / x)))
    pitch = y / count
    tones = (1.0, 0.82)
    folds = visual(
        rod(
            pitch / 2,
            0.96 * z,
            ((0.5 - i % 2) * (x - pitch), pitch * (i + 0.5) - y / 2, 0.48 * z),
            shade(colour, tones[i % 2]),
        )
        for i in range(count)
    )
    return [
        *folds,
        *collision(slab(0.6 * x, y, 0, 0.96 * z, colour)),
        *visual(rod(0.015, y, (0, 0, z - 0.015), BRASS, ALONG_Y)),
    ]


def stairs(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Steps that rise away from the front, towards -x."""
    count = max(3, min(20, round(z / 0.18)))
    run, rise = x / count, z / count
    return [
        box(
            (run, y, rise * (i + 1)),
            (x / 2 - run * (i + 0.5), 0, rise * (i + 1) / 2),
            shade(colour, 1 - 0.12 * (i % 2)),
        )
        for i in range(count)
    ]


def fence(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Pointed pales on two rails."""
    count = max(3, min(24, round(y / 0.14)))
    pitch = y / count
    pales = [
        part
        for i in range(count)
        for part in (
            box((0.5 * x, 0.6 * pitch, 0.93 * z), (0.25 * x, pitch * (i + 0.5) - y / 2, 0.465 * z), colour),
            box(
                (0.5 * x, 0.42 * pitch, 0.42 * pitch),
                (0.25 * x, pitch * (i + 0.5) - y / 2, 0.93 * z),
                colour,
                about("x", math.pi / 4),
            ),
        )
    ]
    rails = visual(box((0.5 * x, y, 0.07 * z), (-0.25 * x, 0, h * z), shade(colour, 0.8)) for h in (0.3, 0.7))
    return [*visual(pales), *rails, *collision(slab(0.9 * x, y, 0, 0.93 * z, colour))]


def switch(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A plate with a tilted rocker."""
    return [
        box((0.5 * x, y, z), (-0.25 * x, 0, z / 2), colour),
        *visual(
            box((0.5 * x, 0.4 * y, 0.55 * z), (0.15 * x, 0, z / 2), shade(colour, 0.85), about("y", 0.12))
        ),
    ]


def socket(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A plate with a round well and two holes."""
    return [
        box((0.8 * x, y, z), (-0.1 * x, 0, z / 2), colour),
        *visual(rod(0.38 * min(y, z), 0.1 * x, (0.33 * x, 0, z / 2), shade(colour, 0.8), ALONG_X)),
        *visual(rod(0.06 * y, 0.1 * x, (0.42 * x, 0.16 * y * s, z / 2), BLACK, ALONG_X) for s in (-1, 1)),
    ]


def thermostat(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A plate with a dial and a display."""
    return [
        box((0.6 * x, y, z), (-0.2 * x, 0, z / 2), colour),
        *visual(rod(0.3 * min(y, z), 0.4 * x, (0.25 * x, 0, 0.36 * z), STEEL, ALONG_X)),
        *visual(box((0.1 * x, 0.7 * y, 0.22 * z), (0.12 * x, 0, 0.82 * z), (0.3, 0.7, 0.5))),
    ]


def handle(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A lever on a rose."""
    rose = min(0.45 * z, 0.2 * y)
    return [
        *visual(rod(rose, 0.25 * x, (-0.37 * x, -0.5 * y + rose, z / 2), shade(colour, 0.8), ALONG_X)),
        *visual(rod(0.35 * rose, 0.8 * x, (0, -0.5 * y + rose, z / 2), colour, ALONG_X)),
        *visual(box((0.25 * x, 0.9 * y, 0.35 * z), (0.35 * x, 0.02 * y, z / 2), colour)),
        *collision(slab(x, y, 0, z, colour)),
    ]


def hook(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Coat hooks on a board."""
    count = max(1, min(6, round(y / 0.12)))
    pitch = y / count
    pegs = visual(
        part
        for i in range(count)
        for part in (
            rod(0.008, 0.8 * x, (0.1 * x, pitch * (i + 0.5) - y / 2, 0.35 * z), STEEL, ALONG_X),
            ball((0.03, 0.03, 0.03), (0.5 * x - 0.015, pitch * (i + 0.5) - y / 2, 0.42 * z), STEEL),
        )
    )
    return [
        box((0.2 * x, y, z), (-0.4 * x, 0, z / 2), colour),
        *pegs,
        *collision(slab(x, 0.9 * y, 0, 0.5 * z, colour)),
    ]


def mirror(x: float, y: float, z: float, colour: Colour) -> Parts:
    """An upright bright pane in a frame."""
    return [
        box((0.7 * x, y, z), (-0.15 * x, 0, z / 2), colour),
        *visual(box((0.3 * x, 0.88 * y, 0.92 * z), (0.35 * x, 0, z / 2), (0.80, 0.90, 0.95))),
        *visual(box((0.01 * x, 0.1 * y, 0.9 * z), (0.5 * x, 0.1 * y, z / 2), WHITE, about("x", 0.3))),
    ]


def picture(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A framed landscape: sky, hills and a sun."""
    return [
        box((0.7 * x, y, z), (-0.15 * x, 0, z / 2), colour),
        *visual(box((0.15 * x, 0.84 * y, 0.8 * z), (0.25 * x, 0, z / 2), (0.60, 0.78, 0.92))),
        *visual(box((0.1 * x, 0.84 * y, 0.3 * z), (0.35 * x, 0, 0.25 * z), (0.30, 0.52, 0.25))),
        *visual(rod(0.09 * min(y, z), 0.1 * x, (0.4 * x, 0.22 * y, 0.7 * z), (0.98, 0.85, 0.35), ALONG_X)),
    ]


def poster(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A sheet on a wall with a bold block and lines."""
    return [
        slab(x, y, 0, z, PAPER),
        *visual(box((0.1 * x, 0.8 * y, 0.5 * z), (x / 2, 0, 0.66 * z), colour)),
        *visual(rod(0.2 * min(y, z), 0.1 * x, (0.55 * x, 0, 0.66 * z), (0.95, 0.85, 0.4), ALONG_X)),
        *visual(box((0.1 * x, 0.7 * y, 0.04 * z), (x / 2, 0, h * z), DARK) for h in (0.12, 0.22, 0.32)),
    ]


def washing_line(x: float, y: float, z: float, colour: Colour) -> Parts:
    """Two T-shaped posts with lines between."""
    posts = [box((0.04, 0.04, z), (0, side * (y / 2 - 0.02), z / 2), STEEL) for side in (-1, 1)]
    arms = [box((x, 0.04, 0.04), (0, side * (y / 2 - 0.02), z - 0.02), STEEL) for side in (-1, 1)]
    feet = [box((0.6 * x, 0.1, 0.02), (0, side * (y / 2 - 0.05), 0.01), DARK) for side in (-1, 1)]
    lines = visual(rod(0.004, y, (x * k, 0, z), WHITE, ALONG_Y) for k in (-0.45, -0.15, 0.15, 0.45))
    cloth = visual(box((0.01, 0.28 * y, 0.3 * z), (0.15 * x, 0.1 * y, 0.85 * z), colour))
    return [*posts, *arms, *feet, *lines, *cloth]


def bathtub(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A hollow tub with a broad rim and a tap at one end."""
    wall_m = 0.08 * min(x, y)
    return [
        *hollow_box(x, y, z - 0.02, wall_m, colour),
        *visual(
            box((x, wall_m * 1.2, 0.02), (0, s * (y - 1.2 * wall_m) / 2, z - 0.01), WHITE) for s in (-1, 1)
        ),
        *visual(
            box((wall_m * 1.2, y, 0.02), (s * (x - 1.2 * wall_m) / 2, 0, z - 0.01), WHITE) for s in (-1, 1)
        ),
        *visual(slab(x - 2 * wall_m, y - 2 * wall_m, wall_m, 0.6 * z, (0.55, 0.78, 0.88))),
        *visual(rod(0.02, 0.12, (0, -0.5 * y + 0.1, z - 0.01), STEEL, ALONG_Y)),
    ]


def shower(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A tray, two glass sides, a riser and a rose."""
    tray = 0.05 * z
    return [
        slab(x, y, 0, tray, colour),
        box((0.015, y, z - tray), (x / 2 - 0.0075, 0, (z + tray) / 2), GLASSY),
        box((x - 0.015, 0.015, z - tray), (-0.0075, y / 2 - 0.0075, (z + tray) / 2), GLASSY),
        *visual(box((0.03, 0.03, z), (x / 2 - 0.015, s * (y / 2 - 0.015), z / 2), STEEL) for s in (-1, 1)),
        *visual(rod(0.015, 0.92 * z, (-0.42 * x, 0, 0.48 * z), STEEL)),
        *visual(rod(0.015, 0.3 * x, (-0.28 * x, 0, 0.93 * z), STEEL, ALONG_X)),
        *visual(rod(0.11, 0.03, (-0.12 * x, 0, 0.915 * z), STEEL)),
    ]


def sink(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A basin with a tap behind; a tall one stands on a pedestal."""
    depth = min(0.2, 0.8 * z)
    rim = z - 0.14 * min(z, 0.9)
    basin = shifted(hollow_box(x, y, depth, 0.09 * min(x, y), colour), z=rim - depth)
    bottom = visual(slab(0.7 * x, 0.7 * y, rim - 0.75 * depth, rim - 0.6 * depth, shade(colour, 0.75)))
    tap = [
        rod(0.018, z - rim, (-0.42 * x, 0, (z + rim) / 2), STEEL),
        rod(0.014, 0.3 * x, (-0.28 * x, 0, z - 0.014), STEEL, ALONG_X),
    ]
    foot = [slab(0.35 * x, 0.3 * y, 0, rim - depth, shade(colour, 0.9))] if rim - depth > 0.02 else []
    return [*basin, *bottom, *visual(tap), *foot]


def toilet(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A bowl with an oval seat, and a cistern behind."""
    seat, tank = 0.52 * z, 0.26 * x
    length = x - tank
    foot = box((0.7 * length, 0.6 * y, seat - 0.05), (tank / 2 - 0.1 * length, 0, (seat - 0.05) / 2), colour)
    return [
        with_cavity(foot, is_open=True, floor=0.5),
        *visual(ball((length, 0.94 * y, 0.7 * seat), (tank / 2, 0, 0.7 * seat), colour)),
        rod(0.45 * y, 0.03, (tank / 2 + 0.02, 0, seat - 0.015), shade(colour, 0.93)),
        *visual(
            ball((0.62 * length, 0.55 * y, 0.02), (tank / 2 + 0.03, 0, seat + 0.001), (0.50, 0.66, 0.74))
        ),
        box((tank, y, z - 0.75 * seat), (-(x - tank) / 2, 0, (z + 0.75 * seat) / 2), colour),
        *visual(rod(0.03, 0.01, (-(x - tank) / 2, 0, z), STEEL)),
    ]


def tap(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A mixer: a column, a spout that bends down, a lever."""
    radius = min(0.15 * x, 0.4 * y)
    return [
        rod(radius, 0.9 * z, (-x / 2 + radius, 0, 0.45 * z), colour),
        *visual(rod(0.6 * radius, 0.85 * x, (0.0, 0, 0.78 * z), colour, ALONG_X)),
        *visual(rod(0.6 * radius, 0.22 * z, (x / 2 - radius, 0, 0.68 * z), colour)),
        *visual(box((0.5 * x, 0.5 * radius, 0.05 * z), (-0.15 * x, 0, 0.97 * z), colour)),
        *collision(box((0.7 * x, radius, 0.2 * z), (0.05 * x, 0, 0.75 * z), colour)),
        *collision(slab(0.94 * x, radius, 0, 0.02 * z, colour)),
    ]
