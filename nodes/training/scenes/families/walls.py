"""The walls and handles of vessels."""

from __future__ import annotations

import numpy as np

from semmap.nodes.training.scenes.solids import Profile, Solid, smooth, tube


def wall(top: float, bottom: float, z: float, bulge: float) -> list[tuple[float, ...]]:
    """From the bottom to the rim; `bulge`: how much wider the middle is than halfway between."""
    middle = 0.5 * (top + bottom) + bulge
    return smooth([(0.97 * bottom, 0.0), (bottom, 0.03 * z), (middle, 0.5 * z), (top, 0.95 * z), (top, z)])


def radius_at(profile: Profile, z: float) -> float:
    """The outer radius of a profile at a height."""
    radii, heights = np.array(profile).T
    return float(np.interp(z, heights, radii))


def handle(
    profile: Profile, heights: tuple[float, float], reach: float, thick: float, *, square: bool
) -> Solid:
    """A handle towards +y between two heights, in its vessel's wall at both ends."""
    low, high = heights
    a, b = (radius_at(profile, height) - 0.5 * thick for height in heights)
    out = max(a, b) + reach
    ends = (
        [(b, high), (out, high)] if square else [(b, high), (0.6 * out + 0.4 * b, 1.04 * high), (out, high)]
    )
    path = smooth([*ends, (out, 0.5 * (low + high)), (0.9 * out, low), (a, low)])
    return tube(np.array([(0.0, y, z) for y, z in path]), thick)
