"""Models of the shipped file as seen by one camera: the points of the surface that face it."""

from __future__ import annotations

import math

import numpy as np

from semmap.nodes.perception_node.fitting.model_surfaces import ModelSurface, shipped
from semmap.schemas.entities import Pose, orientation_from_yaw

EYE = np.array([1.2, 0.0, 1.5])
TOP_M = 0.7


def model(class_: str) -> ModelSurface:
    return shipped()[class_][0]


def rotation(yaw: float) -> np.ndarray:
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def shown(surface: ModelSurface, yaw: float, at=(0.1, 0.2), *, noise_m: float = 0.001) -> np.ndarray:
    """Return the points (N, 3) of a standing model that face the camera, map frame [m], with noise."""
    points = surface.points @ rotation(yaw).T + [*at, TOP_M]
    normals = surface.normals @ rotation(yaw).T
    facing = ((EYE - points) * normals).sum(axis=1) > 0.0
    return points[facing] + np.random.default_rng(0).normal(0.0, noise_m, (int(facing.sum()), 3))


def box(surface: ModelSurface, yaw: float, at=(0.1, 0.2)) -> tuple[Pose, tuple[float, float, float]]:
    x, y, z = surface.size_m.tolist()
    return Pose(position_m=(*at, TOP_M), orientation_wxyz=orientation_from_yaw(yaw)), (x, y, z)
