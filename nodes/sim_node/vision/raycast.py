"""Rendering without OpenGL: one ray per pixel, flat colours, one light with shadows."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from semmap.nodes.sim_node.bodies import Floats
from semmap.nodes.sim_node.physics.build import COLLISION_GROUP
from semmap.nodes.sim_node.vision.view import View, pixel_rays

_SKY_LOW, _SKY_HIGH = np.array([0.90, 0.93, 0.96]), np.array([0.60, 0.74, 0.88])
_LIGHT_M = np.array([-3.0, -5.0, 12.0])  # from the centre of the visible points
_AMBIENT, _HEAD, _LAMP, _SHADOW = 0.30, 0.18, 0.48, 0.55

_VISIBLE = np.array([group != COLLISION_GROUP for group in range(6)], dtype=np.uint8)


def raycast(
    model: mujoco.MjModel, data: mujoco.MjData, view: View, *, shadows: bool = False
) -> tuple[NDArray[np.uint8], NDArray[np.float32], NDArray[np.int32]]:
    """Render the view: rgb (H, W, 3), depth (H, W) [m] along the optical axis, geom (H, W).

    Where nothing is hit, the depth is 0 and the geom -1.
    """
    shape = (view.height, view.width)
    rays = pixel_rays(view)
    lengths = np.linalg.norm(rays, axis=1)
    rotation, eye = view.map_from_camera[:3, :3], view.map_from_camera[:3, 3]
    directions = rays / lengths[:, None] @ rotation.T
    geom, distance, normal = _cast(model, data, eye, directions)
    hit = geom >= 0
    points = eye + directions[hit] * distance[hit, None]
    colour = _sky(directions)
    if hit.any():
        lamp = points.mean(axis=0) + _LIGHT_M
        light = _light(directions[hit], normal[hit], lamp - points)
        if shadows:
            light *= np.where(_in_shadow(model, data, lamp, points), _SHADOW, 1.0)
        colour[hit] = np.minimum(1.0, _colours(model)[geom[hit]] * light[:, None])
    rgb = (np.sqrt(colour) * 255.0 + 0.5).astype(np.uint8)
    depth = np.where(hit, distance / lengths, 0.0).astype(np.float32)
    return rgb.reshape(*shape, 3), depth.reshape(shape), geom.reshape(shape)


def _cast(
    model: mujoco.MjModel, data: mujoco.MjData, origin: Floats, directions: Floats
) -> tuple[NDArray[np.int32], Floats, Floats]:
    count = len(directions)
    geom, distance = np.full(count, -1, np.int32), np.full(count, -1.0)
    normal = np.zeros(3 * count)
    mujoco.mj_multiRay(
        model,
        data,
        origin,
        np.ascontiguousarray(directions).ravel(),
        _VISIBLE,
        True,
        -1,
        geom,
        distance,
        normal,
        count,
        mujoco.mjMAXVAL,
    )
    return geom, distance, normal.reshape(-1, 3)


def _light(directions: Floats, normals: Floats, to_lamp: Floats) -> Floats:
    facing = np.abs(np.einsum("ij,ij->i", directions, normals))
    lamp = np.einsum("ij,ij->i", to_lamp, normals) / np.linalg.norm(to_lamp, axis=1)
    return np.asarray(_AMBIENT + _HEAD * facing + _LAMP * np.maximum(0.0, lamp))


def _in_shadow(model: mujoco.MjModel, data: mujoco.MjData, lamp: Floats, points: Floats) -> NDArray[np.bool_]:
    rays = points - lamp
    lengths = np.linalg.norm(rays, axis=1)
    _, distance, _ = _cast(model, data, lamp, rays / lengths[:, None])
    return np.asarray(distance < lengths - 0.005)


def _colours(model: mujoco.MjModel) -> Floats:
    """Return (ngeom, 3) the linear colour of each geom, from its material, mean texture, or own colour."""
    own = model.geom_rgba[:, :3].astype(float)
    painted = model.geom_matid >= 0
    own[painted] = _paints(model)[model.geom_matid[painted]]
    return np.asarray(own**2)


def _paints(model: mujoco.MjModel) -> Floats:
    """Return (nmat, 3) the mean colour of each material."""
    paints = model.mat_rgba[:, :3].astype(float)
    for material, texture in enumerate(model.mat_texid[:, mujoco.mjtTextureRole.mjTEXROLE_RGB]):
        if texture >= 0 and model.tex_nchannel[texture] >= 3:
            start, channels = model.tex_adr[texture], model.tex_nchannel[texture]
            size = model.tex_height[texture] * model.tex_width[texture] * channels
            texels = model.tex_data[start : start + size].reshape(-1, channels)
            paints[material] *= texels[:, :3].mean(axis=0) / 255.0
    return np.asarray(paints)


def _sky(directions: Floats) -> Floats:
    height = np.clip(directions[:, 2:], 0.0, 1.0)
    return np.asarray((_SKY_LOW + (_SKY_HIGH - _SKY_LOW) * height) ** 2)
