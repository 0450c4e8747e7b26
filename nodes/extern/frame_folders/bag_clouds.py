"""The point clouds in a rosbag or an MCAP file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.extern.frame_folders.bag import Bag, open_bag
from semmap.nodes.extern.frame_folders.poses import MAPS, TransformTree, stamp_ns_of, strip_slash
from semmap.nodes.extern.frame_folders.topics import TRANSFORMS
from semmap.nodes.extern.ros.frames import Transform
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.files.cloud_files import checked
from semmap.nodes.perception_node.input.files.columns import MAX_POINTS, cloud_of
from semmap.nodes.perception_node.input.viewpoint import Placement
from semmap.schemas.errors import BadFile, BadRequest
from semmap.schemas.wording import counted, few

CLOUD: Final = "sensor_msgs/msg/PointCloud2"
_TYPES: Final = ("i1", "u1", "i2", "u2", "i4", "u4", "f4", "f8")
"""The types of fields in a `sensor_msgs/PointField`, from 1."""


def read_clouds(
    path: Path, placement: Placement, *, topic: str | None, every_s: float
) -> Iterator[tuple[str, Cloud]]:
    """Yield clouds of a recording that are at least `every_s` seconds apart, each with a name for messages.

    If /tf has the frame of the clouds in `map`, `world` or `odom`, the cloud is in that frame. Otherwise
    `placement` describes its frame. Clouds with too few points, as of a covered camera, are skipped, which
    the next one notes. Raises BadFile, also if all are skipped, and BadRequest if the topic is missing or
    unclear.
    """
    with open_bag(path) as bag:
        topic = _choose(path, bag, topic)
        tree = TransformTree()
        transforms = [name for name, of in bag.types.items() if of in TRANSFORMS]
        for name, message in bag.messages(transforms):
            tree.take(message, static=name.endswith("_static"))
        next_ns: int | None = None
        skipped = list[BadFile]()
        for _, message in bag.messages([topic]):
            stamp_ns = stamp_ns_of(message.header.stamp)
            if next_ns is not None and stamp_ns < next_ns:
                continue
            name = f"{path} {topic} {stamp_ns / 1e9:.3f} s"
            try:
                cloud = checked(_cloud(message, placement, tree), Path(name))
            except ValueError as error:
                raise BadFile(f"{name}: {error}") from None
            except BadFile as error:
                skipped.append(error)
                continue
            next_ns = stamp_ns + round(every_s * 1e9)
            if skipped:
                note = f"{counted(len(skipped), 'cloud')} before it skipped: {skipped[0].text}"
                cloud, skipped = replace(cloud, notes=(*cloud.notes, note)), []
            yield name, cloud
        if next_ns is None and skipped:
            raise skipped[0]


def _choose(path: Path, bag: Bag, topic: str | None) -> str:
    """Return the only topic with clouds, or the given one."""
    topics = sorted(name for name, of in bag.types.items() if of == CLOUD)
    if not topics:
        raise BadFile(
            f"{path} has no point clouds (sensor_msgs/PointCloud2); convert images with: semmap frames {path}"
            " DIR"
        )
    if topic is not None and topic not in topics:
        raise BadRequest(f"{path}: no point clouds on {topic}; topics with clouds: {few(topics)}")
    if topic is None and len(topics) > 1:
        raise BadRequest(f"{path}: point clouds on several topics: {few(topics)}; choose one with --topic")
    return topic or topics[0]


def _cloud(message: Any, placement: Placement, tree: TransformTree) -> Cloud:
    columns = columns_of(message)
    pose = None if placement.up else _pose(message, tree)
    if pose is not None and "optical" in message.header.frame_id:
        placement = Placement(None, pose)
    elif pose is not None:
        placed = np.stack([columns[axis] for axis in "xyz"], axis=-1) @ pose[:3, :3].T + pose[:3, 3]
        columns |= dict(zip("xyz", placed.T, strict=True))
        placement = Placement("z")
    return cloud_of(columns, message.height, message.width, placement)


def _pose(message: Any, tree: TransformTree) -> Transform | None:
    """Return the pose (4, 4) of a cloud's frame in that of the map, if it is known."""
    frame = strip_slash(message.header.frame_id)
    base = next((name for name in MAPS if name in tree.above(frame)), None)
    return None if base is None else tree.pose(frame, base, stamp_ns_of(message.header.stamp))


def columns_of(message: Any) -> dict[str, NDArray[Any]]:
    """Return each field with one element per point of a `sensor_msgs/PointCloud2`, (points,).

    Raises ValueError if its fields do not fit its data.
    """
    height, width, step, row = message.height, message.width, message.point_step, message.row_step
    order = ">" if message.is_bigendian else "<"
    fields = [field for field in message.fields if field.count == 1 and 1 <= field.datatype <= len(_TYPES)]
    formats = [np.dtype(order + _TYPES[field.datatype - 1]) for field in fields]
    ends = [field.offset + of.itemsize for field, of in zip(fields, formats, strict=True)]
    if height * width > MAX_POINTS or max(ends, default=0) > step or step < 1 or row < width * step:
        raise ValueError(f"the cloud declares {width} x {height} points that do not fit its fields")
    if len(message.data) < height * row:
        raise ValueError(f"the cloud is truncated: {len(message.data)} of {height * row} bytes")
    if len({field.name for field in fields}) < len(fields):
        raise ValueError("the cloud has two fields of the same name")
    kind = np.dtype(
        {
            "names": [field.name for field in fields],
            "formats": formats,
            "offsets": [field.offset for field in fields],
            "itemsize": step,
        }
    )
    body = np.ascontiguousarray(message.data[: height * row]).view(np.uint8).reshape(height, row)
    points = np.ascontiguousarray(body[:, : width * step]).reshape(-1).view(kind)
    return {
        field.name: points[field.name].astype(of.newbyteorder("="))
        for field, of in zip(fields, formats, strict=True)
    }
