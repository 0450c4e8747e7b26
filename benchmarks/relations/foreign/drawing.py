"""A small notation for MJCF worlds: trees of bodies with geoms, and the hollows that were drawn in them.

Lengths are in metres, angles in degrees. The place of a geom is the centre of its bottom in the frame of its
body.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

Vec3 = tuple[float, float, float]


class Hollow(NamedTuple):
    """A space that was drawn to hold things: a box, or an upright cylinder, in the frame of a body."""

    body: str
    size: Vec3
    at: Vec3
    """The centre of its bottom."""
    round: bool = False


@dataclass(frozen=True)
class Part:
    """Geoms and hollows without a body of their own."""

    geoms: str
    hollows: tuple[tuple[Vec3, Vec3, bool], ...] = ()
    assets: str = ""

    def __add__(self, other: Part) -> Part:
        return Part(self.geoms + other.geoms, self.hollows + other.hollows, self.assets + other.assets)


@dataclass(frozen=True)
class Body:
    """A body of a world; `joint` is the text of its joint, and a free body falls."""

    name: str
    at: Vec3
    part: Part = Part("")
    children: Sequence[Body] = ()
    yaw: float = 0.0
    tilt: float = 0.0
    """The angle about the y axis of its parent, after `yaw`."""
    joint: str = ""
    own: bool = False
    """A nested body that a person would call an object of its own."""

    def text(self) -> str:
        """Return the MJCF."""
        inner = self.joint + self.part.geoms + "".join(child.text() for child in self.children)
        where = " ".join(f"{value:.5g}" for value in self.at)
        return f'<body name="{self.name}" pos="{where}" euler="0 {self.tilt} {self.yaw}">{inner}</body>'

    def walk(self) -> Iterator[Body]:
        """Yield the body and those in it."""
        yield self
        for child in self.children:
            yield from child.walk()


@dataclass(frozen=True)
class ForeignWorld:
    """A drawn world."""

    name: str
    bodies: tuple[Body, ...]
    open: dict[str, float] = field(default_factory=dict)
    """Positions of joints, where not 0."""
    stated: tuple[tuple[str, str, str], ...] = ()
    """Relations of two fixed bodies, for which physics has no contact forces."""

    def text(self) -> str:
        """Return the MJCF of the world."""
        assets = "".join(body.part.assets for top in self.bodies for body in top.walk())
        return (
            f'<mujoco model="{self.name}"><compiler angle="degree" autolimits="true"/>'
            '<option timestep=".002" integrator="implicitfast"/>'
            '<default><geom density="300" friction="1 .01 .004" condim="6"/>'
            '<joint damping=".5" frictionloss=".3"/></default>'
            f'<asset>{assets}</asset><worldbody><light pos="0 0 4"/>'
            '<geom name="floor" type="plane" size="0 0 .1"/>'
            + "".join(body.text() for body in self.bodies)
            + "</worldbody></mujoco>"
        )

    def owners(self) -> dict[str, str]:
        """Return the thing that each body is a part of."""
        found: dict[str, str] = {}

        def descend(body: Body, thing: str) -> None:
            thing = body.name if body.own or not thing else thing
            found[body.name] = thing
            for child in body.children:
                descend(child, thing)

        for top in self.bodies:
            descend(top, "")
        return found

    def hollows(self) -> list[Hollow]:
        """Return all hollows with the bodies that they move with."""
        return [
            Hollow(body.name, *hollow)
            for top in self.bodies
            for body in top.walk()
            for hollow in body.part.hollows
        ]


def free(name: str, at: Vec3, part: Part, *children: Body, yaw: float = 0.0, tilt: float = 0.0) -> Body:
    """Return a body that falls."""
    return Body(name, at, part, children, yaw, tilt, "<freejoint/>")


def fixed(name: str, at: Vec3, part: Part = Part(""), *children: Body, yaw: float = 0.0) -> Body:
    """Return a body without a joint."""
    return Body(name, at, part, children, yaw)


def sliding(name: str, at: Vec3, part: Part, joint: str, axis: str, reach: float) -> Body:
    """Return a nested body that slides, such as a drawer."""
    return Body(name, at, part, joint=f'<joint name="{joint}" type="slide" axis="{axis}" range="0 {reach}"/>')


def turning(
    name: str, at: Vec3, part: Part, joint: str, axis: str, reach: float, hinge: str = "0 0 0"
) -> Body:
    """Return a nested body on a hinge, such as a door."""
    text = f'<joint name="{joint}" type="hinge" axis="{axis}" pos="{hinge}" range="0 {reach}"/>'
    return Body(name, at, part, joint=text)


def own(body: Body) -> Body:
    """Return a nested body as an object of its own."""
    return replace(body, own=True)


def box(size: Vec3, at: Vec3 = (0.0, 0.0, 0.0), more: str = "") -> Part:
    """Return a box by its full size."""
    return _geom("box", [value / 2 for value in size], (at[0], at[1], at[2] + size[2] / 2), more)


def tube(radius: float, height: float, at: Vec3 = (0.0, 0.0, 0.0), more: str = "") -> Part:
    """Return an upright cylinder."""
    return _geom("cylinder", [radius, height / 2], (at[0], at[1], at[2] + height / 2), more)


def ball(radius: float, at: Vec3 = (0.0, 0.0, 0.0)) -> Part:
    """Return a sphere."""
    return _geom("sphere", [radius], (at[0], at[1], at[2] + radius), "")


def bar(radius: float, start: Vec3, end: Vec3) -> Part:
    """Return a capsule between two points."""
    ends = " ".join(f"{value:.5g}" for value in (*start, *end))
    return Part(f'<geom type="capsule" size="{radius}" fromto="{ends}"/>')


def hull(name: str, points: Iterable[Vec3], at: Vec3 = (0.0, 0.0, 0.0)) -> Part:
    """Return a mesh, the hull of points."""
    vertices = " ".join(f"{x + at[0]:.5g} {y + at[1]:.5g} {z + at[2]:.5g}" for x, y, z in points)
    return Part(f'<geom type="mesh" mesh="{name}"/>', assets=f'<mesh name="{name}" vertex="{vertices}"/>')


def prism(name: str, low: Sequence[tuple[float, float]], height: float, grow: float = 1.0) -> Part:
    """Return a mesh with a polygon as base, whose top is larger by a factor."""
    return hull(name, [(x, y, 0.0) for x, y in low] + [(x * grow, y * grow, height) for x, y in low])


def legs(width: float, depth: float, height: float, thick: float = 0.04) -> Part:
    """Return four legs at the corners of a rectangle."""
    x, y = (width - thick) / 2, (depth - thick) / 2
    return sum_of(box((thick, thick, height), (sx * x, sy * y, 0.0)) for sx in (-1, 1) for sy in (-1, 1))


def table(width: float, depth: float, height: float, thick: float = 0.03) -> Part:
    """Return a board on four legs."""
    return legs(width, depth, height - thick) + box((width, depth, thick), (0.0, 0.0, height - thick))


def crate(size: Vec3, at: Vec3 = (0.0, 0.0, 0.0), wall: float = 0.01, floor: float | None = None) -> Part:
    """Return a box that is open at the top, with its hollow."""
    (w, d, h), (x, y, z), floor = size, at, wall if floor is None else floor
    walls = [
        box((w, d, floor), at),
        *(box((wall, d, h - floor), (x + s * (w - wall) / 2, y, z + floor)) for s in (-1, 1)),
        *(box((w - 2 * wall, wall, h - floor), (x, y + s * (d - wall) / 2, z + floor)) for s in (-1, 1)),
    ]
    room = (w - 2 * wall, d - 2 * wall, h - floor)
    return sum_of(walls) + Part("", ((room, (x, y, z + floor), False),))


def case(size: Vec3, at: Vec3 = (0.0, 0.0, 0.0), wall: float = 0.02, closed: bool = True) -> Part:
    """Return a cupboard that is open to -y; it has a hollow if `closed` (a door will be in front of it)."""
    (w, d, h), (x, y, z) = size, at
    walls = [
        box((w, d, wall), at),
        box((w, d, wall), (x, y, z + h - wall)),
        *(box((wall, d, h - 2 * wall), (x + s * (w - wall) / 2, y, z + wall)) for s in (-1, 1)),
        box((w - 2 * wall, wall, h - 2 * wall), (x, y + (d - wall) / 2, z + wall)),
    ]
    room = ((w - 2 * wall, d - wall, h - 2 * wall), (x, y - wall / 2, z + wall), False)
    return sum_of(walls) + Part("", (room,) if closed else ())


def ring(radius: float, height: float, wall: float, foot: float | None = None, staves: int = 12) -> Part:
    """Return a round wall of staves, narrower at its foot."""
    foot = radius if foot is None else foot
    lean = math.atan2(radius - foot, height)
    middle, length = (radius + foot) / 2 - wall / 2, math.hypot(height, radius - foot)
    wide = 2 * math.pi * radius / staves * 1.1
    found = Part("")
    for number in range(staves):
        c, s = math.cos(2 * math.pi * number / staves), math.sin(2 * math.pi * number / staves)
        out = f"{math.cos(lean) * c:.5g} {math.cos(lean) * s:.5g} {-math.sin(lean):.5g}"
        at = (middle * c, middle * s, height / 2)
        found += _geom("box", [wall / 2, wide / 2, length / 2], at, f'xyaxes="{out} {-s:.5g} {c:.5g} 0"')
    return found


def vessel(
    radius: float, height: float, wall: float = 0.006, foot: float | None = None, staves: int = 14
) -> Part:
    """Return a round vessel of staves, with its hollow."""
    wide = 2 * (radius - wall)
    hollow = ((wide, wide, height - wall), (0.0, 0.0, wall), True)
    return (
        tube(radius if foot is None else foot, wall)
        + ring(radius, height, wall, foot, staves)
        + Part("", (hollow,))
    )


def sum_of(parts: Iterable[Part]) -> Part:
    """Return parts as one."""
    return sum(parts, Part(""))


def _geom(kind: str, size: Sequence[float], at: Vec3, more: str) -> Part:
    sizes, where = (" ".join(f"{value:.5g}" for value in values) for values in (size, at))
    return Part(f'<geom type="{kind}" size="{sizes}" pos="{where}" {more}/>')
