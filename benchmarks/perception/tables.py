"""Things on tables of all heights, in clouds of unknown pose: organised, shuffled, and thinned to voxels."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.perception.rooms import low_rooms
from benchmarks.perception.simulated import LEAST_PIXELS, SAME_IOU, shots
from benchmarks.perception.table import Row
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.pipeline import observe_clouds
from semmap.nodes.perception_node.recognition.recognition_model import RecognitionModel

HEIGHTS_M = (0.2, 0.3, 0.45, 0.49, 0.75, 1.1)
VOXEL_M = 0.005
_SEED = 20275

Owners = NDArray[np.int32]


def measure(scenes: int, learnt: RecognitionModel) -> list[Row]:
    """Return the share of things found on tables of each height, for each form of their clouds."""
    rows = []
    for height_m in HEIGHTS_M:
        seen = list(shots(low_rooms(scenes, _SEED, height_m), seed=3))
        asked, found, said = 0, dict[str, int](), dict[str, int]()
        for _, shot in seen:
            kinds = [body.name != "support" for body in shot.bodies]
            visible = np.bincount(shot.owners[0].ravel(), minlength=len(kinds) + 1)[1:] >= LEAST_PIXELS
            wanted = np.flatnonzero(visible & kinds) + 1
            asked += len(wanted)
            for form, cloud, owners in forms(shot.clouds[0], shot.owners[0]):
                result = observe_clouds([cloud], learnt)
                hits = len(found_of(wanted, owners, result.labels[0]))
                found[form] = found.get(form, 0) + hits
                said[form] = said.get(form, 0) + len(result.observations.observations)
        rows += [
            Row(f"table of {height_m:g} m, pose unknown, {form}: {said[form]} reported, found", n / asked)
            for form, n in found.items()
        ]
    return rows


def forms(cloud: Cloud, owners: Owners) -> Iterator[tuple[str, Cloud, Owners]]:
    """Yield a cloud without its pose in each form, with the number of the body of each point."""
    bare = replace(cloud, map_from_camera=None)
    yield "organised", bare, owners
    assert cloud.colors is not None
    seen = np.isfinite(cloud.points_camera[..., 2])
    points, colors, owner = cloud.points_camera[seen], cloud.colors[seen], owners[seen]
    order = np.random.default_rng(0).permutation(len(points))
    bare = replace(bare, intrinsics=None)
    yield (
        "shuffled",
        replace(bare, points_camera=points[order][None], colors=colors[order][None]),
        owner[order][None],
    )
    _, first, voxel, count = np.unique(
        np.floor(points / VOXEL_M).astype(np.int64) @ np.array([1 << 40, 1 << 20, 1]),
        return_index=True,
        return_inverse=True,
        return_counts=True,
    )
    middle = np.stack([np.bincount(voxel, axis) for axis in points.T.astype(float)], axis=-1) / count[:, None]
    colour = np.stack([np.bincount(voxel, axis) for axis in colors.T.astype(float)], axis=-1) / count[:, None]
    yield (
        f"{1000 * VOXEL_M:g} mm voxels",
        replace(bare, points_camera=middle.astype(np.float32)[None], colors=colour.astype(np.uint8)[None]),
        owner[first][None],
    )


def found_of(wanted: NDArray[np.int64], owners: Owners, labels: NDArray[np.int32]) -> list[int]:
    """Return the wanted bodies of which a label covers more than half, by intersection over union."""
    width = int(labels.max(initial=0)) + 1
    both = np.bincount(
        owners.ravel() * width + labels.ravel(), minlength=(int(owners.max()) + 1) * width
    ).reshape(-1, width)
    union = both.sum(axis=1, keepdims=True) + both.sum(axis=0, keepdims=True) - both
    iou = both / np.maximum(union, 1)
    return [int(n) for n in wanted if n < len(iou) and (iou[n, 1:] > SAME_IOU).any()]
