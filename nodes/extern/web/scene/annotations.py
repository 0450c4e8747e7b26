"""Labels, outlines and lines in the scene of a tab."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import count

import numpy as np
from numpy.typing import NDArray
from viser import LabelHandle, LineSegmentsHandle, SceneApi

from semmap.nodes.extern.web.scene.meshes import linear
from semmap.schemas.entities import Vector

Rgb = tuple[int, int, int]
Segments = NDArray[np.float32]
LabelText = tuple[str, Vector]
"""A text and its position [m], map frame."""
_STAYS_M = 1e-3


class Labels:
    """Texts at points, by key. Only changes are sent."""

    def __init__(self, scene: SceneApi, path: str, *, scale: float = 1.0, depth_test: bool = False) -> None:
        self._scene, self._path = scene, path
        self._scale, self._depth_test = scale, depth_test
        self._drawn: dict[str, tuple[LabelHandle, str, Vector]] = {}
        self._numbers = count()

    def show(self, wanted: Mapping[str, LabelText]) -> None:
        """Show these labels, and remove all others."""
        for key in self._drawn.keys() - wanted.keys():
            self._drawn.pop(key)[0].remove()
        for key, (text, at) in wanted.items():
            found = self._drawn.get(key)
            if found is not None and found[1] == text:
                if math.dist(found[2], at) > _STAYS_M:
                    found[0].position = at
                    self._drawn[key] = (found[0], text, at)
                continue
            if found is not None:
                found[0].remove()
            self._drawn[key] = (self._add(text, at), text, at)

    def _add(self, text: str, at: Vector) -> LabelHandle:
        return self._scene.add_label(
            f"{self._path}/{next(self._numbers)}",
            text,
            position=at,
            font_screen_scale=self._scale,
            depth_test=self._depth_test,
            anchor="bottom-center",
        )


class Lines:
    """Lines of one kind, in one node."""

    def __init__(self, scene: SceneApi, path: str, *, width: float = 2.0) -> None:
        self._scene, self._path, self._width = scene, path, width
        self._handle: LineSegmentsHandle | None = None
        self._drawn = b""

    def show(self, pieces: Sequence[tuple[Segments, Rgb]]) -> None:
        """Show these line segments (N, 2, 3) [m], each array with its colour, and remove all others."""
        segments = join_segments(piece for piece, _ in pieces)
        colours = np.concatenate(
            [np.empty((0, 2, 3)), *(np.tile(_linear_rgb(rgb), (len(piece), 2, 1)) for piece, rgb in pieces)]
        ).astype(np.uint8)
        if (now := segments.tobytes() + colours.tobytes()) == self._drawn:
            return
        self._drawn = now
        if not len(segments):
            if self._handle is not None:
                self._handle.remove()
                self._handle = None
            return
        self._handle = self._scene.add_line_segments(
            self._path, segments, colours, thickness=self._width, thickness_units="screen"
        )


def _linear_rgb(rgb: Rgb) -> NDArray[np.float32]:
    """Return a colour as viser expects it for lines: linear, not sRGB."""
    return np.asarray(np.round(255.0 * linear(np.array(rgb, dtype=np.uint8))))


def line(a: Vector, b: Vector) -> Segments:
    """Return the line between two points, of shape (1, 2, 3)."""
    return np.array([(a, b)], dtype=np.float32)


def dashed_line(a: Vector, b: Vector, dash_m: float = 0.08) -> Segments:
    """Return a dashed line between two points, of shape (N, 2, 3)."""
    start, direction = np.array(a), np.array(b) - np.array(a)
    pieces = max(1, min(200, round(float(np.linalg.norm(direction)) / dash_m / 2.0)))
    at = np.arange(pieces)[:, None] / pieces
    return np.stack([start + at * direction, start + (at + 0.5 / pieces) * direction], axis=1).astype(
        np.float32
    )


def join_segments(outlines: Iterable[Segments]) -> Segments:
    """Return all segments in one array."""
    return np.concatenate([np.empty((0, 2, 3), np.float32), *outlines])
