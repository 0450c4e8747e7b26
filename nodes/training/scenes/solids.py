"""Surfaces by formulas: profiles turned about an axis, tubes along paths, lumps; and ways to bend them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.sim_node.models.parts import Colour, Floats, Part, about, mesh, rotation_matrix

_SLICES, _ROUND = 20, 9
_LEAST_M = 2e-4

Profile = Sequence[tuple[float, ...]]
"""Radius and height [m], point after point."""


class Solid(NamedTuple):
    """`vertices`: (N, 3) [m], `faces`: (M, 3) of rows of these, counterclockwise from outside."""

    vertices: Floats
    faces: NDArray[np.int32]

    def part(self, colour: Colour) -> Part:
        """Return a part in one colour, in place."""
        return mesh(self.vertices, self.faces, colour)

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Solid:
        """Return the solid translated."""
        return self._replace(vertices=self.vertices + np.array([x, y, z]))

    def turned(self, axis: str, angle_rad: float) -> Solid:
        """Return the solid rotated about the axis x, y or z through the origin."""
        return self._replace(vertices=self.vertices @ rotation_matrix(about(axis, angle_rad)).T)

    def scaled(self, x: float = 1.0, y: float = 1.0, z: float = 1.0) -> Solid:
        """Return the solid scaled along the axes."""
        return self._replace(vertices=self.vertices * (x, y, z))

    def lipped(self, reach_m: float, width_rad: float, from_share: float) -> Solid:
        """Return the solid with a lip towards +y, from a share of the height up to the rim."""
        x, y, z = self.vertices.T
        height = (z - z.min()) / (z.max() - z.min())
        up = np.clip((height - from_share) / (1.0 - from_share), 0.0, 1.0) ** 2
        off = np.arctan2(x, y) / width_rad
        drawn = self.vertices.copy()
        drawn[:, 1] += reach_m * up * np.exp(-(off**2))
        return self._replace(vertices=drawn)

    def lumpy(self, share: float, rng: np.random.Generator) -> Solid:
        """Return the solid with smooth radial deformations up to about this amount."""
        middle = self.vertices.mean(axis=0)
        away = self.vertices - middle
        towards = away / np.maximum(np.linalg.norm(away, axis=1, keepdims=True), _LEAST_M)
        waves, shifts = rng.normal(0.0, 1.8, (3, 4)), rng.uniform(0.0, 2.0 * math.pi, 4)
        factors = 1.0 + share * np.sin(towards @ waves + shifts).mean(axis=1, keepdims=True)
        return self._replace(vertices=middle + away * factors)


def lathe(profile: Profile, *, slices: int = _SLICES) -> Solid:
    """A profile turned about z. It begins and ends on the axis, and is closed there."""
    radii, heights = np.array(profile).T
    angles = np.arange(slices) * (2.0 * math.pi / slices)
    rings = np.stack(
        [
            np.outer(radii, np.cos(angles)),
            np.outer(radii, np.sin(angles)),
            np.repeat(heights[:, None], slices, axis=1),
        ],
        axis=2,
    )
    return _closed(
        np.maximum(radii, _LEAST_M), rings, np.array([[0.0, 0.0, heights[0]], [0.0, 0.0, heights[-1]]])
    )


def tube(path: Floats, radii: Floats | float, *, slices: int = _ROUND) -> Solid:
    """A round rod along a path (K, 3) of given radii (K,) [m], closed at both ends.

    The path keeps near one plane.
    """
    path = np.asarray(path, float)
    thick = np.broadcast_to(np.asarray(radii, float), len(path))
    along = np.gradient(path, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    _, _, axes = np.linalg.svd(path - path.mean(axis=0))
    up = axes[2] - along * (along @ axes[2])[:, None]
    up /= np.maximum(np.linalg.norm(up, axis=1, keepdims=True), _LEAST_M)
    beside = np.cross(up, along)
    angles = np.arange(slices) * (2.0 * math.pi / slices)
    circle = np.cos(angles)[:, None] * beside[:, None] + np.sin(angles)[:, None] * up[:, None]
    return _closed(thick, path[:, None] + thick[:, None, None] * circle, path[[0, -1]])


def lump(x: float, y: float, z: float, *, square: float = 1.0) -> Solid:
    """A ball of these extents [m] upon the ground; `square` below 1 makes it a rounded box.

    A superellipsoid (Barr, 1981).
    """
    angles = np.linspace(-math.pi / 2.0, math.pi / 2.0, 15)
    ball = lathe(list(zip(np.cos(angles).tolist(), np.sin(angles).tolist(), strict=True)))
    squared = np.sign(ball.vertices) * np.abs(ball.vertices) ** square
    return Solid(
        squared / np.abs(squared).max(axis=0) * (x / 2, y / 2, z / 2) + (0.0, 0.0, z / 2), ball.faces
    )


def smooth(points: Sequence[Sequence[float]], times: int = 2) -> list[tuple[float, ...]]:
    """A path whose corners are cut off, again and again (Chaikin, 1974); its ends stay."""
    path = np.array(points, float)
    for _ in range(times):
        cut = np.stack([0.75 * path[:-1] + 0.25 * path[1:], 0.25 * path[:-1] + 0.75 * path[1:]], axis=1)
        path = np.concatenate([path[:1], cut.reshape(-1, path.shape[1])[1:-1], path[-1:]])
    return [tuple(point) for point in path.tolist()]


def hollow(outside: Profile, wall_m: float, floor_m: float) -> list[tuple[float, ...]]:
    """The profile of a vessel with this outside, from the bottom to the rim, and down inside to its floor."""
    bottom = outside[0][1] + floor_m
    inside = [(max(r - wall_m, _LEAST_M), z) for r, z in reversed(outside) if z > bottom]
    return [(0.0, outside[0][1]), *outside, *inside, (inside[-1][0], bottom), (0.0, bottom)]


def full(outside: Profile) -> list[tuple[float, ...]]:
    """The profile of what is closed above, and full."""
    return [(0.0, outside[0][1]), *outside, (0.0, outside[-1][1])]


def _closed(radii: Floats, rings: Floats, ends: Floats) -> Solid:
    """Rings (K, S, 3), one after the other, and a point at either end."""
    count, slices, _ = rings.shape
    keep = radii > _LEAST_M
    rings = rings[keep]
    count = len(rings)
    here = np.arange(slices)
    beside = (here + 1) % slices
    first = slices * np.arange(count - 1)[:, None]
    low, low_next, high, high_next = (first + n for n in (here, beside, here + slices, beside + slices))
    walls = np.concatenate(
        [np.stack([low, low_next, high_next], axis=2), np.stack([low, high_next, high], axis=2)]
    ).reshape(-1, 3)
    last = slices * (count - 1)
    bottom = np.column_stack([beside, here, np.full(slices, count * slices)])
    top = np.column_stack([last + here, last + beside, np.full(slices, count * slices + 1)])
    vertices = np.concatenate([rings.reshape(-1, 3), ends])
    return Solid(vertices, np.concatenate([walls, bottom, top]).astype(np.int32))
