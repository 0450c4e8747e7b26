"""Perception as Rerun archetypes: boxes, points and camera images."""

from __future__ import annotations

import io

import numpy as np
import rerun as rr
from PIL import Image

from semmap.nodes.drawing.palette import GREY, colour_of
from semmap.schemas.entities import Pose
from semmap.schemas.perception import Observation, Observations, SegmentedCloud
from semmap.schemas.scenes import CameraFrame

BOXES = "map/perception/boxes"
CLOUD = "map/perception/cloud"
OBSERVATION_FIELDS = "semmap.Observation"
"""The archetype with the observations' fields for programs."""

_PICTURE_WIDTH = 320
_JPEG_QUALITY = 80
_FRUSTUM_M = 0.15
_POINT_M = 0.004


def camera_path(camera: str) -> str:
    """Return the path of a camera's drawings."""
    return f"map/perception/cameras/{camera}"


def boxes_of(seen: Observations) -> tuple[rr.AsComponents, ...]:
    """Return the boxes of all observations of a frame with class and probability, and these as fields."""
    things = seen.observations
    boxes = rr.Boxes3D(
        half_sizes=np.array([thing.size_m for thing in things]).reshape(-1, 3) / 2.0,
        centers=[_middle(thing) for thing in things],
        quaternions=[rr.Quaternion(xyzw=np.roll(thing.pose.orientation_wxyz, -1)) for thing in things],
        colors=[colour_of(thing.class_) for thing in things],
        fill_mode=rr.components.FillMode.MajorWireframe,
        labels=[_label(thing) for thing in things],
        show_labels=True,
    )
    fields = {  # typed, since Rerun drops the first record of an untyped empty array
        "class": rr.components.TextBatch([thing.class_ for thing in things]),
        "probability": rr.components.ScalarBatch([thing.probability for thing in things]),
        "entity": rr.components.TextBatch([thing.entity for thing in things]),
    }
    return boxes, rr.DynamicArchetype(OBSERVATION_FIELDS, components=fields)


def points_of(cloud: SegmentedCloud, seen: Observations) -> rr.Points3D:
    """Return the points of a frame, coloured by class. Raises ValueError for an invalid cloud."""
    count = len(cloud.positions) // 12
    if (len(cloud.positions), len(cloud.colors), len(cloud.labels)) != (12 * count, 3 * count, 2 * count):
        raise ValueError("its positions, colours and labels are not of the same number of points")
    labels = np.frombuffer(cloud.labels, "<u2")
    colors = np.frombuffer(cloud.colors, np.uint8).reshape(-1, 3).copy()
    palette = np.array([GREY, *(colour_of(thing.class_) for thing in seen.observations)], np.uint8)
    of_things = (labels > 0) & (labels < len(palette))
    colors[of_things] = palette[labels[of_things]]
    return rr.Points3D(np.frombuffer(cloud.positions, "<f4").reshape(-1, 3), colors=colors, radii=[_POINT_M])


def camera_pose(frame: CameraFrame) -> Pose:
    """Return the pose of a camera. Raises ValueError if the frame has none."""
    x, y, z = np.array(frame.map_from_camera).reshape(4, 4)[:3, 3].tolist()
    return Pose(position_m=(x, y, z))


def image_of(frame: CameraFrame, pixels: bytes) -> tuple[rr.AsComponents, ...]:
    """Return a camera with its image, scaled down. Raises ValueError if the pixels do not fit the frame."""
    image = Image.frombuffer("RGB", (frame.width, frame.height), pixels, "raw", "RGB", 0, 1)
    width = min(_PICTURE_WIDTH, frame.width)
    height = max(1, round(frame.height * width / frame.width))
    out = io.BytesIO()
    image.resize((width, height), Image.Resampling.BOX).save(out, "JPEG", quality=_JPEG_QUALITY)
    scale = np.diag([width / frame.width, height / frame.height, 1.0])
    pose = np.array(frame.map_from_camera).reshape(4, 4)
    pinhole = rr.Pinhole(
        image_from_camera=scale @ np.array(frame.intrinsics).reshape(3, 3),
        resolution=[width, height],
        image_plane_distance=_FRUSTUM_M,
    )
    camera = rr.Transform3D(translation=pose[:3, 3], mat3x3=pose[:3, :3])
    return camera, pinhole, rr.EncodedImage(contents=out.getvalue(), media_type="image/jpeg")


def _middle(thing: Observation) -> tuple[float, float, float]:
    x, y, z = thing.pose.position_m
    return (x, y, z + thing.size_m[2] / 2.0)


def _label(thing: Observation) -> str:
    text = f"{thing.class_} {thing.probability:.0%}"
    return f"{thing.entity}: {text}" if thing.entity else text
