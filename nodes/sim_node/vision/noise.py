"""Noise model of a structured-light depth camera, like the first Kinect."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# z = focal length * baseline / disparity, and disparity comes in steps of an eighth of a pixel
_FOCAL_BASELINE_PX_M = 580.0 * 0.075
_DISPARITY_STEP_PX = 0.125
_DISPARITY_SIGMA_PX = 0.08
_NEAREST_M, _FARTHEST_M = 0.5, 6.0
_EDGE_STEP = 0.05
_DROPOUT = 0.004


def kinect_noise(depth_m: NDArray[np.float32], rng: np.random.Generator) -> NDArray[np.float32]:
    """Return depth (H, W) [m] with the noise of such a camera; 0 for no measurement.

    Noise and steps grow with the square of the distance (3 mm at 1 m, 12 mm at 2 m). Edges of things are lost
    in the projector's shadow, and depth is limited to 0.5 to 6 m.
    """
    seen = (depth_m >= _NEAREST_M) & (depth_m <= _FARTHEST_M)
    disparity = _FOCAL_BASELINE_PX_M / np.where(seen, depth_m, 1.0)
    disparity = disparity + rng.normal(0.0, _DISPARITY_SIGMA_PX, depth_m.shape)
    disparity = np.round(disparity / _DISPARITY_STEP_PX) * _DISPARITY_STEP_PX
    lost = ~seen | _shadow(depth_m) | (rng.random(depth_m.shape) < _DROPOUT)
    return np.where(lost, 0.0, _FOCAL_BASELINE_PX_M / np.maximum(disparity, 1.0)).astype(np.float32)


def _shadow(depth_m: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Return pixels to the left of a step towards the camera, which the projector does not reach."""
    step = np.zeros(depth_m.shape, dtype=bool)
    step[:, :-1] = depth_m[:, :-1] - depth_m[:, 1:] > _EDGE_STEP * depth_m[:, 1:]
    wide = step.copy()
    for shift in (1, 2, 3):
        wide[:, :-shift] |= step[:, shift:]
    return wide
