"""Static real frames with the noise of a depth camera: entities and their identity over a minute.

The depth of each look has its own noise, whose standard deviation grows with the square of the distance. What
stands there does not change, so neither should the map.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from benchmarks.perception.table import Row
from benchmarks.perception.tracking import ObedientMap
from semmap.nodes.perception_node.config import TrackingConfig
from semmap.nodes.perception_node.image_features.image_evidence import with_images
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.files.frame_folders import frames_in, read_frame
from semmap.nodes.perception_node.input.projection import cloud_of
from semmap.nodes.perception_node.observer import Observer
from semmap.nodes.perception_node.recognition.recognition_model import RecognitionModel
from semmap.nodes.perception_node.tracking.association import associate
from semmap.nodes.perception_node.tracking.class_hierarchy import ClassHierarchy
from semmap.nodes.perception_node.tracking.occupancy import occupancy_in
from semmap.nodes.perception_node.tracking.tracks import Tracks
from semmap.nodes.perception_node.views.segmented_view import segment_cloud
from semmap.schemas.commands import Add, Remove, Update

SIGMA_M = 0.0012
"""Standard deviation of the depth at 1 m; it grows with the square of the distance."""
LOOKS = 120
"""A minute at 2 Hz."""
_EARLY = 10
"""Number of looks in which a map may come to rest."""
_JUMP_M = 0.3


class Stay(NamedTuple):
    """What became of the map: entities early and at the end, changes after the early looks, and jumps.

    `things`: the number of things there. `early`, `late`: entities after `_EARLY` looks, and at the end.
    `added`, `removed`: entities after the early looks. `jumps`: moves by more than `_JUMP_M`.
    """

    things: int
    early: int
    late: int
    added: int
    removed: int
    jumps: int


def stay(folder: Path, learnt: RecognitionModel, looks: int = LOOKS, seed: int = 0) -> Stay:
    """Show a frame many times, each with its own noise."""
    rng, still = np.random.default_rng(seed), placed(read_frame(folder).cloud)
    classes = ClassHierarchy(
        {name: frozenset(above) for name, above in learnt.ancestors.items()}, {}, learnt.usual_m
    )
    observer, semantic_map, tracks, config = Observer(learnt), ObedientMap(), Tracks(), TrackingConfig()
    early = added = removed = jumps = 0
    for look in range(looks):
        clouds = [noisy(still, rng, look)]
        seen = observer(clouds).observations.observations
        told = associate(semantic_map.entities, tracks, seen, occupancy_in(clouds), classes, config)
        tracks = told.tracks
        for command in told.commands:
            match command:
                case Add() if look >= _EARLY:
                    added += 1
                case Remove() if look >= _EARLY:
                    removed += len(command.names)
                case Update(name=name, at=at) if at is not None:
                    pose = semantic_map.entities[name].pose
                    jumps += pose is not None and math.dist(pose.position_m, at) > _JUMP_M
            semantic_map.obey(command)
        if look < _EARLY:
            early = len(semantic_map.entities)
    truth = json.loads((folder / "truth.json").read_text())["objects"]
    return Stay(len(truth), early, len(semantic_map.entities), added, removed, jumps)


def placed(cloud: Cloud) -> Cloud:
    """Return the cloud with a known pose, as a camera in a room has it."""
    if cloud.map_from_camera is not None:
        return replace(cloud, camera="camera")
    return replace(cloud, map_from_camera=segment_cloud(cloud).map_from_camera, camera="camera")


def noisy(cloud: Cloud, rng: np.random.Generator, look: int, sigma_m: float = SIGMA_M) -> Cloud:
    """Return the cloud with noise of its own, in whole millimetres as a camera gives it."""
    depth = cloud.points_camera[..., 2]
    noise = rng.standard_normal(depth.shape, np.float32) * np.float32(sigma_m) * depth**2
    rounded = np.round((depth + noise) * 1000) / np.float32(1000)
    if cloud.intrinsics is None:
        raise ValueError("the intrinsics of the camera are unknown")
    again = cloud_of(rounded.astype(np.float32), cloud.colors, cloud.intrinsics, cloud.map_from_camera)
    return replace(again, camera=cloud.camera, stamp_ns=look * 500_000_000)


def measure(
    folder: Path, learnt: RecognitionModel, names: Sequence[str] = (), looks: int = LOOKS
) -> list[Row]:
    """Return the figures of the frames in a folder, or of those named."""
    if not folder.is_dir():
        print(f"no real frames in {folder}: set SEMMAP_DATA")
        return []
    learnt = with_images(learnt, live=True)
    frames = [frame for frame in frames_in(folder) if not names or frame.name in names]
    found = {frame.name: stay(frame, learnt, looks) for frame in frames}
    for name, one in found.items():
        print(f"{name:16}{one}", flush=True)
    beyond = [max(0, one.late - one.things) for one in found.values()]
    return [
        Row(
            "static frames with noise: entities beyond the things there, mean",
            float(np.mean(beyond)),
            "",
            1,
            less=True,
        ),
        Row("the same, the worst frame", float(max(beyond))),
        Row("entities that came after 5 s, a frame", float(np.mean([one.added for one in found.values()]))),
        Row("entities that went after 5 s, a frame", float(np.mean([one.removed for one in found.values()]))),
        Row(
            f"moves by more than {_JUMP_M} m, all frames",
            float(sum(one.jumps for one in found.values())),
            "",
            0,
            less=True,
        ),
    ]
