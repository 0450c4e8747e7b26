"""Bodies in a viser scene: one batched mesh per model. Only changes are sent."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import count
from typing import Any, Final

import numpy as np
from viser import BatchedGlbHandle, BatchedMeshHandle, SceneApi

from semmap.nodes.extern.web.scene.drawables import BOX, Batch, Drawable, Key, batch_of, by_key
from semmap.nodes.extern.web.scene.meshes import cube, opacity_of
from semmap.schemas.entities import Pose

_MANY: Final = 400
"""With more bodies than this, distant ones are simplified, and there are no shadows."""

Handle = BatchedGlbHandle | BatchedMeshHandle


class Bodies:
    """The bodies in the scene of one tab."""

    def __init__(self, scene: SceneApi, glb_of: Callable[[Key], bytes], path: str = "/bodies") -> None:
        """`glb_of(key)` returns the glTF file of a batch with a model."""
        self._scene = scene
        self._glb_of = glb_of
        self._path = path
        self._batches: dict[Key, Batch] = {}
        self._shown: dict[Key, Mapping[str, Drawable]] = {}
        """The contents of the batches that have not been moved since they were created."""
        self._handles: dict[Key, Handle] = {}
        self._rows: dict[str, tuple[Key, int]] = {}
        self._numbers = count()

    def show(self, things: Mapping[str, Drawable]) -> None:
        """Show these bodies, and remove all others."""
        wanted, is_many = by_key(things), len(things) > _MANY
        for key in self._batches.keys() - wanted.keys():
            self._handles.pop(key).remove()
            del self._batches[key]
            self._shown.pop(key, None)
        for key, some in wanted.items():
            if not _is_identical(self._shown.get(key), some):
                batch = batch_of(some)
                self._set(key, batch, many=is_many)
                self._batches[key], self._shown[key] = batch, some
        self._rows = {name: (key, row) for key, some in wanted.items() for row, name in enumerate(some)}

    def move(self, poses: Mapping[str, Pose]) -> None:
        """Set the poses of shown bodies."""
        moved: set[Key] = set()
        for name, pose in poses.items():
            if (found := self._rows.get(name)) is not None:
                key, row = found
                batch = self._batches[key]
                batch.positions[row] = pose.position_m
                batch.wxyzs[row] = pose.orientation_wxyz
                moved.add(key)
        for key in moved:
            self._shown.pop(key, None)
            self._send(self._handles[key], self._batches[key])

    def _set(self, key: Key, batch: Batch, *, many: bool) -> None:
        before, handle = self._batches.get(key), self._handles.get(key)
        if before is None or handle is None:
            self._handles[key] = self._add(key, batch, many=many)
        elif key[1] == BOX and not _has_same_shapes(before, batch):
            handle.remove()
            self._handles[key] = self._add(key, batch, many=many)
        elif before.names != batch.names or not _has_same_poses(before, batch):
            self._send(handle, batch)

    @staticmethod
    def _send(handle: Handle, batch: Batch) -> None:
        handle.batched_positions = batch.positions
        handle.batched_wxyzs = batch.wxyzs

    def _add(self, key: Key, batch: Batch, *, many: bool) -> Handle:
        appearance, model, _, _ = key
        name = f"{self._path}/{next(self._numbers)}"
        is_clear = opacity_of(appearance) < 1.0
        common: dict[str, Any] = {
            "batched_positions": batch.positions,
            "batched_wxyzs": batch.wxyzs,
            "cast_shadow": not (many or is_clear),
            "receive_shadow": not (many or is_clear),
        }
        handle: Handle
        if model == BOX:
            points, triangles = cube()
            handle = self._scene.add_batched_meshes_simple(
                name,
                points,
                triangles,
                batched_scales=batch.sizes,
                batched_colors=batch.colours,
                opacity=opacity_of(appearance) if is_clear else None,
                flat_shading=True,
                lod="off",
                **common,
            )
        else:
            handle = self._scene.add_batched_glb(
                name, self._glb_of(key), lod="auto" if many else "off", **common
            )
        return handle


def _is_identical(before: Mapping[str, Drawable] | None, now: Mapping[str, Drawable]) -> bool:
    """Return whether both have the same objects in the same order; unchanged ones are never copied."""
    if before is None or len(before) != len(now):
        return False
    return all(a is b for a, b in zip(before.values(), now.values(), strict=True)) and [*before] == [*now]


def _has_same_shapes(before: Batch, now: Batch) -> bool:
    """Return whether the boxes have the same number, sizes and colours."""
    return np.array_equal(before.sizes, now.sizes) and np.array_equal(before.colours, now.colours)


def _has_same_poses(before: Batch, now: Batch) -> bool:
    return np.array_equal(before.positions, now.positions) and np.array_equal(before.wxyzs, now.wxyzs)
