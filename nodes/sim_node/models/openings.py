"""Boxes without a front, and the doors, flaps and drawers before them. The front is at +x."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from semmap.nodes.sim_node.models.forms import WALL_M, shade, shifted
from semmap.nodes.sim_node.models.parts import Colour, Joint, Part, Parts, Vec3, box, moving

WIDE = math.radians(100.0)
"""Opening angle of a door [rad]."""
GAP_M = 0.002
"""Gap between moving and fixed parts."""
SIDES = ((-1, "left"), (1, "right"))
"""Sides as seen from the front: the sign of y, and the name of a door there."""


def cabinet_box(
    size: Vec3,
    centre: Vec3,
    colour: Colour,
    *,
    boards: Sequence[float] = (),
    depth: float = 1.0,
    lining: Colour | None = None,
) -> Parts:
    """Return a box of full extents `size` that is open at its front, with boards.

    Boards are at these shares of its height, and extend over this share of its `depth` from the back.
    """
    x, y, z = size
    wall = wall_of(size)
    inner = lining or shade(colour, 0.92)
    a, b, c = x - wall, y - 2 * wall, z - 2 * wall
    walls = [
        box((x, y, wall), (0.0, 0.0, (wall - z) / 2), colour),
        box((x, y, wall), (0.0, 0.0, (z - wall) / 2), colour),
        box((wall, y, c), ((wall - x) / 2, 0.0, 0.0), colour),
        *(box((a, wall, c), (wall / 2, side * (y - wall) / 2, 0.0), colour) for side in (-1, 1)),
        *(
            box(
                (depth * a - wall, b, wall),
                (wall / 2 + (depth - 1.0) * a / 2 - wall / 2, 0.0, (share - 0.5) * z),
                inner,
            )
            for share in boards
        ),
    ]
    return shifted(walls, x=centre[0], y=centre[1], z=centre[2])


def framed_box(
    size: Vec3,
    centre: Vec3,
    colour: Colour,
    hole: tuple[float, float, float, float],
    *,
    boards: Sequence[float] = (),
    depth: float = 1.0,
) -> Parts:
    """Return such a box with a front that has an opening: its minimum and maximum y and z [m]."""
    x, y, z = size
    wall = wall_of(size)
    left, right, bottom, top = hole
    low, high = centre[2] - z / 2, centre[2] + z / 2
    strips = [
        (centre[1] - y / 2, centre[1] + y / 2, low, bottom),
        (centre[1] - y / 2, centre[1] + y / 2, top, high),
        (centre[1] - y / 2, left, bottom, top),
        (right, centre[1] + y / 2, bottom, top),
    ]
    front = [
        box(
            (wall, y1 - y0, z1 - z0),
            (centre[0] + (x - wall) / 2, (y0 + y1) / 2, (z0 + z1) / 2),
            colour,
        )
        for y0, y1, z0, z1 in strips
        if y1 - y0 > GAP_M and z1 - z0 > GAP_M
    ]
    return [*cabinet_box(size, centre, colour, boards=boards, depth=depth), *front]


def flap(name: str, parts: Part | Iterable[Part], hinge: Vec3, *, opens: float = math.pi / 2) -> Parts:
    """Return a flap that tips forwards and down about a horizontal hinge below, as an oven door does."""
    joint = Joint(name=name, kind="hinge", anchor=hinge, axis=(0.0, 1.0, 0.0), range=(0.0, opens))
    return moving(joint, _parts(parts))


def pull_out(
    name: str,
    size: Vec3,
    centre: Vec3,
    colour: Colour,
    *,
    panel: tuple[float, float],
    thick: float = 0.012,
    face: Part | Iterable[Part] = (),
    travel: float = 0.65,
) -> Parts:
    """Return a drawer: a tray of full extents `size`, with a front panel of width and height `panel`.

    It slides out by the share `travel` of its depth; `face` are the visible parts of the panel.
    """
    x, y, z = size
    cx, cy, cz = centre
    wall = 0.008
    joint = Joint(
        name=name,
        kind="slide",
        anchor=centre,
        axis=(1.0, 0.0, 0.0),
        range=(0.0, travel * x),
        friction=3.0,
    )
    tray = [
        box((x, y, wall), (cx, cy, cz + (wall - z) / 2), shade(colour, 0.8)),
        box((wall, y, z - wall), (cx + (wall - x) / 2, cy, cz + wall / 2), shade(colour, 0.8)),
        *(
            box(
                (x - wall, wall, z - wall), (cx + wall / 2, cy + side * (y - wall) / 2, cz + wall / 2), colour
            )
            for side in (-1, 1)
        ),
        box((thick, *panel), (cx + (x + thick) / 2, cy, cz), shade(colour, 1.2)),
    ]
    return moving(joint, [*tray, *_parts(face)])


def wall_of(size: Vec3) -> float:
    """Return the wall thickness of a box of this size [m]."""
    return min(max(WALL_M, 0.018 * max(size[0], size[1])), 0.1 * min(size))


def side_door(
    name: str,
    size: Vec3,
    centre: Vec3,
    colour: Colour,
    *,
    handle: Part | Iterable[Part] = (),
    hinge: int = 1,
    opens: float = WIDE,
    friction: float = 0.4,
) -> Parts:
    """Return a door that turns about an upright hinge at its +y side (`hinge` 1) or its -y side (-1)."""
    x, y, _ = size
    joint = Joint(
        name=name,
        kind="hinge",
        anchor=(centre[0] + x / 2, centre[1] + hinge * y / 2, centre[2]),
        axis=(0.0, 0.0, float(hinge)),
        range=(0.0, opens),
        friction=friction,
    )
    return moving(joint, [box(size, centre, colour), *_parts(handle)])


def _parts(parts: Part | Iterable[Part]) -> Parts:
    return [parts] if isinstance(parts, Part) else list(parts)
