"""Recorded scenes with the truth in a `label` field: those of the Modified Object Segmentation Database."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.files import pcd
from semmap.nodes.perception_node.input.files.columns import cloud_of

_FIRST_OBJECT = 20  # below: what is invalid, and the table; from here on ten numbers an object, for its parts
_PARTS = 10


class Scene(NamedTuple):
    """A cloud, and (H, W) the number of each point's object, from 1, 0 for what is none.

    `valid`: (H, W) whether the truth says anything.
    """

    name: str
    cloud: Cloud
    truth: NDArray[np.int32]
    valid: NDArray[np.bool_]


def read_scenes(folder: Path) -> Iterator[Scene]:
    """The scenes of a folder, by name. Raises ValueError for clouds without labels."""
    for path in sorted(folder.glob("*.pcd"), key=lambda path: (len(path.stem), path.stem)):
        yield read_scene(path)


def read_scene(path: Path) -> Scene:
    """One scene. Raises ValueError for a cloud without labels."""
    data = path.read_bytes()
    header, start = pcd.read_header(data)
    columns = pcd.read_columns(header, data[start:])
    if "label" not in columns:
        raise ValueError(f"{path} has no field label")
    cloud = cloud_of(columns, header.height, header.width)
    label = columns["label"].astype(np.int32).reshape(header.height, header.width)
    truth = np.where(label >= _FIRST_OBJECT, label // _PARTS - _FIRST_OBJECT // _PARTS + 1, 0)
    return Scene(path.stem, cloud, truth.astype(np.int32), label > 0)


def mirrored(scene: Scene) -> Scene:
    """As seen in a mirror: left is right. The cloud must be organised."""
    points = scene.cloud.points_camera[:, ::-1] * np.array([-1, 1, 1], np.float32)
    colors = None if scene.cloud.colors is None else scene.cloud.colors[:, ::-1]
    cloud = replace(scene.cloud, points_camera=points, colors=colors)
    return Scene(scene.name, cloud, scene.truth[:, ::-1], scene.valid[:, ::-1])
