"""Clouds in the frame of a map or robot: the camera that saw them, and their points in its frame. Pure."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, cast

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Floats, Transform

Up = Literal["x", "y", "z", "-x", "-y", "-z"]

_TURNS = {
    "x": np.array([[0.0, 0, -1], [0, 1, 0], [1, 0, 0]]),
    "y": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "z": np.eye(3),
    "-x": np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]]),
    "-y": np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]),
    "-z": np.diag([1.0, -1, -1]),
}
_SAMPLE, _FEW = 6000, 3000
_LEVEL_M, _FLOOR_SHARE, _BELOW_M = 0.03, 0.03, 0.06
_ABOVE_M, _THINGS = 0.15, 0.05
_ELEVATIONS_RAD = np.radians([25.0, 40.0, 60.0])
_RADII_M = (1.0, 1.5, 2.5)
_AZIMUTHS, _FARTHER = 12, 1.3
_PER_M = 0.05
"""The share of hidden points that is as bad as a metre of distance."""
_WIDE = 1.5
"""Points with a larger tangent to the axis are not seen."""
_HEIGHTS_M = (0.0, 0.5, 1.0, 1.5)
_CELLS = 60
_HIDDEN = 0.03
"""Share of its distance by which a point is behind another in the same direction."""
_WORST_PX = 1.0
_FEWEST = 100
_MOST_HIDDEN, _LEVEL_SHARE = 0.5, 0.1
"""A camera's points hide less than this share of one another. A level surface has at least this share."""


@dataclass(frozen=True)
class Placement:
    """The frame of a cloud: its axis `up`, and the camera's pose (4, 4) in that frame, if known.

    Without `up`, it is the camera's frame, and the pose is `map_from_camera`; unless no camera at its origin
    can have seen the points.
    """

    up: Up | None = None
    frame_from_camera: Transform | None = None

    def place(self, points: Floats) -> tuple[Floats, Transform]:
        """Return points (H, W, 3) in the camera's frame (x right, y down, z forward), and map_from_camera.

        The map frame is that of the points, turned so that z is up. A floor below z = 0 becomes z = 0. If the
        pose of the camera is unknown, that of an organised cloud follows from its rows and columns; otherwise
        it is a place from which few points are hidden.
        """
        turn = _TURNS[self.up or "z"]
        turned = points @ turn.T.astype(np.float32)
        seen = turned[np.isfinite(turned).all(axis=-1) & (turned != 0.0).any(axis=-1)]
        if len(seen) < 3:
            return turned, np.eye(4)
        lift_m = -min(0.0, _floor_m(seen[:, 2]))
        pose = None
        if self.frame_from_camera is not None:
            pose = self.frame_from_camera.copy()
            pose[:3] = turn @ pose[:3]
        if pose is None:
            pose = _of_grid(turned)
        if pose is None:
            pose = _of_many(seen[:: max(1, len(seen) // _FEW)].astype(float))
        in_camera = (turned - pose[:3, 3].astype(np.float32)) @ pose[:3, :3].astype(np.float32)
        pose[2, 3] += lift_m
        return in_camera, pose


def is_seen_from_origin(points: Floats) -> bool:
    """Return whether a camera at the origin (x right, y down, z forward) could have seen points (N, 3)."""
    seen = _sample(points)
    return len(seen) < _FEWEST or hidden(seen, np.eye(4)) < _MOST_HIDDEN


def find_up(points: Floats) -> tuple[Up, bool] | None:
    """Return the axis along which most points (N, 3) are at one level; None if there is no such level.

    The second value is whether the axis may point down, because more points are below the level than above.
    """
    seen = _sample(points)
    if len(seen) < _FEWEST:
        return None
    found: dict[Up, tuple[int, int]] = {}
    for axis, along in zip(("x", "y", "z"), seen.T, strict=True):
        levels, counts = np.unique(np.floor(along / _LEVEL_M), return_counts=True)
        level = float(levels[counts.argmax()] + 0.5) * _LEVEL_M
        above, below = along > level + _BELOW_M, along < level - _BELOW_M
        found[cast("Up", axis)] = int(counts.max()), int(above.sum() - below.sum())
    best = max(found, key=found.__getitem__)
    count, more_above = found[best]
    return (best, more_above < 0) if count > _LEVEL_SHARE * len(seen) else None


def _sample(points: Floats) -> NDArray[np.float64]:
    """Return some of the measured points (N, 3)."""
    seen = points[np.isfinite(points).all(axis=-1) & (points != 0.0).any(axis=-1)]
    return np.asarray(seen[:: max(1, len(seen) // _FEW)], np.float64)


def _floor_m(heights: NDArray[np.floating]) -> float:
    """Return the height of the lowest level with many points, 0 if it is not clearly below 0."""
    levels, counts = np.unique(np.floor(heights.astype(float) / _LEVEL_M), return_counts=True)
    lowest = float(levels[np.argmax(counts >= _FLOOR_SHARE * len(heights))] + 0.5) * _LEVEL_M
    near = np.abs(heights - lowest) < _LEVEL_M
    floor = float(np.median(heights[near])) if near.any() else 0.0
    return floor if floor < -_BELOW_M else 0.0


def _of_grid(points: Floats) -> Transform | None:
    """Return the pose of the pinhole camera whose pixels the points (H, W, 3) are; None if there is none.

    It is the least squares solution of the linear equations between pixels and points.
    """
    height, width = points.shape[:2]
    if min(height, width) < 2:
        return None
    rows, columns = np.nonzero(np.isfinite(points).all(axis=-1) & (points != 0.0).any(axis=-1))
    if len(rows) < _FEWEST:
        return None
    some = slice(None, None, max(1, len(rows) // _SAMPLE))
    rows, columns = rows[some], columns[some]
    own = points[rows, columns].astype(float)
    middle, spread = own.mean(axis=0), own.std() or 1.0
    size = float(max(height, width))
    x = np.column_stack([(own - middle) / spread, np.ones(len(own))])
    u, v = (columns - width / 2) / size, (rows - height / 2) / size
    nothing = np.zeros_like(x)
    equations = np.block([[x, nothing, -u[:, None] * x], [nothing, x, -v[:, None] * x]])
    matrix = np.linalg.svd(equations.T @ equations)[2][-1].reshape(3, 4)
    if np.median(x @ matrix[2]) < 0:
        matrix = -matrix
    along = x @ matrix.T
    if not (along[:, 2] > 0).all():
        return None
    off = np.hypot(along[:, 0] / along[:, 2] - u, along[:, 1] / along[:, 2] - v) * size
    if np.quantile(off, 0.9) > _WORST_PX:
        return None
    turn, upper = np.linalg.qr(matrix[::-1, :3].T)  # an RQ decomposition by that of the reversed rows
    turn, upper = turn.T[::-1], upper.T[::-1, ::-1]
    turn = np.diag(np.sign(np.diag(upper))) @ turn
    if np.linalg.det(turn) < 0:
        return None  # mirrored
    pose = np.eye(4)
    pose[:3, :3] = turn.T
    pose[:3, 3] = middle - spread * np.linalg.solve(matrix[:, :3], matrix[:, 3])
    return pose


def _of_many(points: NDArray[np.float64]) -> Transform:
    """Return the pose, of several possible ones, that is near and from which few points (N, 3) are hidden.

    These are the axis of the frame, where a robot has its camera, and circles around the middle of what is
    above the lowest level, since a floor extends everywhere. Perception trusts near points more.
    """
    above = points[points[:, 2] > np.quantile(points[:, 2], 0.02) + _ABOVE_M]
    middle = np.median(above if len(above) > _THINGS * len(points) else points, axis=0)
    widest = _FARTHER * float(np.quantile(np.linalg.norm(points - middle, axis=1), 0.98)) + 0.3
    eyes = [np.array([0.0, 0.0, height]) for height in _HEIGHTS_M]
    for radius in (*(r for r in _RADII_M if r < widest), widest):
        for elevation in _ELEVATIONS_RAD:
            for a in (np.arange(_AZIMUTHS) * 2 * np.pi / _AZIMUTHS).tolist():
                around = [np.cos(a) * np.cos(elevation), np.sin(a) * np.cos(elevation), np.sin(elevation)]
                eyes.append(middle + radius * np.array(around))
    poses = [pose for eye in eyes if (pose := _looking(eye, middle)) is not None]
    return min(
        poses,
        key=lambda pose: hidden(points, pose) + _PER_M * float(np.linalg.norm(pose[:3, 3] - middle)),
    )


def _looking(eye: NDArray[np.float64], target: NDArray[np.float64]) -> Transform | None:
    """Return the pose (4, 4) of a level camera; None if it would look straight up or down."""
    forward = target - eye
    distance = np.linalg.norm(forward)
    if distance < 1e-3 or np.linalg.norm(forward[:2]) < 1e-3 * distance:
        return None
    forward /= distance
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([right, np.cross(forward, right), forward])
    pose[:3, 3] = eye
    return pose


def hidden(points: NDArray[np.float64], pose: Transform) -> float:
    """Return the share of points (N, 3) that are not in the camera's view or hidden by others."""
    x, y, z = ((points - pose[:3, 3]) @ pose[:3, :3]).T
    ahead = (z > 0.05) & (np.maximum(np.abs(x), np.abs(y)) < _WIDE * z)
    if not ahead.any():
        return 1.0
    rays = np.stack([x[ahead], y[ahead]]) / z[ahead]
    low, high = np.quantile(rays, [0.01, 0.99], axis=1)
    cells = np.clip((rays.T - low) / max(float((high - low).max()), 1e-6) * _CELLS, 0, _CELLS - 1).astype(int)
    cell = cells[:, 1] * _CELLS + cells[:, 0]
    nearest = np.full(_CELLS * _CELLS, np.inf)
    np.minimum.at(nearest, cell, z[ahead])
    visible = z[ahead] < nearest[cell] * (1.0 + _HIDDEN)
    return 1.0 - float(visible.sum()) / len(points)
