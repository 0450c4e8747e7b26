"""What opens: boxes without a front, and the doors, flaps and drawers before them. The front is at +x."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from nodes.sim_node.models.forms import WALL_M, shade, shifted
from nodes.sim_node.models.parts import Colour, Joint, Part, Parts, Vec3, box, moving

WIDE = math.radians(100.0)
"""How far a door opens [rad]."""
GAP_M = 0.002
"""Between what moves and what does not."""


def cabinet_box(
    size: Vec3,
    centre: Vec3,
    colour: Colour,
    *,
    boards: Sequence[float] = (),
    depth: float = 1.0,
    lining: Colour | None = None,
) -> Parts:
    """A box of full extents `size` that is open at its front, with room in it and boards.

    Boards lie at these shares of its height, and reach so much of its `depth` from the back.
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


def wall_of(size: Vec3) -> float:
    """How thick the walls of a box of this size are [m]."""
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
    """A leaf that turns about an upright hinge at its +y side (`hinge` 1) or its -y side (-1)."""
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
