"""Texture augmentation, so that shape recognition does not depend on the colours of our models.

Paint is applied to the pixels of an object in rendered images and keeps their shading. Patterns are defined
in the object's coordinates, so that all cameras see the same.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

Bytes = NDArray[np.uint8]
Floats = NDArray[np.float32]
Pattern = Callable[[Floats], Floats]
"""From (N, 3) points in a thing's own coordinates, -1 to 1 along each side, to (N, 3) colours in [0, 1]."""

_LEAST_LIGHT, _MOST_LIGHT = 0.35, 1.5
_SHARES = {"plain": 0.36, "dark": 0.14, "light": 0.11, "halves": 0.13, "print": 0.17, "patches": 0.09}
_TEXTURE_LIGHT = (0.45, 0.9)
"""The brightness of a texture under a camera's light."""


@dataclass(frozen=True)
class Paint:
    """The paint of one thing, with the brightness factor `glow`; None leaves its own colours."""

    pattern: Pattern | None
    glow: float = 1.0


def any_paint(rng: np.random.Generator, own: float, texture: Pattern | None = None) -> Paint:
    """Return its own colours under other light with this probability, or a random paint.

    `texture`: its own colours, if the pictures of it do not show them.
    """
    if rng.random() < own:
        if texture is not None:
            return Paint(texture, float(rng.uniform(*_TEXTURE_LIGHT)))
        return Paint(None, float(np.exp(rng.normal(0.0, 0.15))))
    kind = str(rng.choice(list(_SHARES), p=list(_SHARES.values())))
    return Paint(_PATTERNS[kind](rng))


def black(_: np.random.Generator) -> Paint:
    """Return a dark paint."""
    return Paint(_plain(np.full(3, 0.06, np.float32)))


def one_colour(rng: np.random.Generator) -> Paint:
    """Return a single random colour."""
    return Paint(_plain(_colour(rng)))


def painted(colours: Bytes, points: Floats, paint: Paint) -> Bytes:
    """Return (N, 3) painted rgb of a thing's pixels; `points`: (N, 3) their positions, see `Pattern`."""
    if paint.pattern is None:
        return np.asarray(np.clip(colours * np.float32(paint.glow), 0, 255), np.uint8)
    grey = colours.mean(axis=1, dtype=np.float32) + 1.0
    light = np.clip(grey / np.median(grey), _LEAST_LIGHT, _MOST_LIGHT)
    lit = 255.0 * paint.glow * paint.pattern(points) * light[:, None]
    return np.asarray(np.clip(lit, 0, 255), np.uint8)


def printed_on(vertices: Floats, colours: Floats) -> Pattern:
    """Return a pattern with these colours (V, 3) at vertices (V, 3), in the coordinates of `Pattern`."""
    tree = KDTree(vertices)
    return lambda points: colours[tree.query(points)[1]]


def _colour(rng: np.random.Generator) -> Floats:
    """Return a random colour of any hue, saturation and brightness."""
    hue, saturation, value = rng.random(), rng.random() ** 0.7, rng.uniform(0.12, 0.95)
    wheel = np.abs((6.0 * hue + np.array([0.0, 4.0, 2.0])) % 6.0 - 3.0) - 1.0
    return np.asarray(value * (1.0 - saturation * (1.0 - np.clip(wheel, 0.0, 1.0))), np.float32)


def _plain(colour: Floats) -> Pattern:
    return lambda points: np.broadcast_to(colour, points.shape)


def _grey(low: float, high: float) -> Callable[[np.random.Generator], Pattern]:
    return lambda rng: _plain(
        np.clip(rng.uniform(low, high) + rng.normal(0.0, 0.015, 3), 0.0, 1.0).astype(np.float32)
    )


def _halves(rng: np.random.Generator) -> Pattern:
    """Return a pattern of two colours, divided at a height or side by side, like lids and handles."""
    axis, at = int(rng.choice([0, 1, 2, 2, 2])), float(rng.uniform(-0.6, 0.8))
    one, other = _colour(rng), _colour(rng)
    return lambda points: np.where((points[:, axis] > at)[:, None], one, other)


def _print(rng: np.random.Generator) -> Pattern:
    """Return a colour with a band and spots of others, like a printed label."""
    base, band = _colour(rng), _colour(rng)
    low, high = np.sort(rng.uniform(-0.9, 0.9, 2))
    blots, spots = rng.uniform(-1.0, 1.0, (6, 3)), np.array([_colour(rng) for _ in range(6)])
    size = rng.uniform(0.1, 0.5, 6)

    def pattern(points: Floats) -> Floats:
        found = np.where(((points[:, 2] > low) & (points[:, 2] < high))[:, None], band, base)
        for blot, spot, reach in zip(blots, spots, size, strict=True):
            found = np.where((np.abs(points - blot).max(axis=1) < reach)[:, None], spot, found)
        return found.astype(np.float32)

    return pattern


def _patches(rng: np.random.Generator) -> Pattern:
    """Return a pattern in which each point has the colour of the nearest seed."""
    count = int(rng.integers(3, 9))
    seeds, colours = rng.uniform(-1.0, 1.0, (count, 3)), np.array([_colour(rng) for _ in range(count)])
    return lambda points: colours[((points[:, None] - seeds) ** 2).sum(axis=2).argmin(axis=1)]


_PATTERNS: dict[str, Callable[[np.random.Generator], Pattern]] = {
    "plain": lambda rng: _plain(_colour(rng)),
    "dark": _grey(0.02, 0.2),
    "light": _grey(0.8, 1.0),
    "halves": _halves,
    "print": _print,
    "patches": _patches,
}
