"""Recordings made with the writers of rosbags and mcap, and folders in the TUM format."""

from __future__ import annotations

import io
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from mcap.writer import Writer as McapWriter
from PIL import Image
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from semmap.nodes.extern.ros.types import new, store
from tests.extern.ros.made import image, info, transforms

WIDTH, HEIGHT = 60, 40
COLOUR, DEPTH = "/camera/color/image_raw", "/camera/aligned_depth_to_color/image_raw"
INFO = "/camera/color/camera_info"
FRAME = "camera_color_optical_frame"
RGB = np.zeros((HEIGHT, WIDTH, 3), np.uint8) + np.arange(WIDTH, dtype=np.uint8)[None, :, None]
RGB[..., 1] = 200
MM = (1000 + 10 * np.arange(HEIGHT)[:, None] + np.zeros((1, WIDTH))).astype(np.uint16)
ROS1 = get_typestore(Stores.ROS1_NOETIC)
ROS1.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage"))


class Said(NamedTuple):
    """A message on its topic, and when."""

    topic: str
    stamp_ns: int
    message: Any


def seconds(count: float) -> int:
    return 1_700_000_000_000_000_000 + round(count * 1e9)


def table(count: int = 3, *, apart_s: float = 0.1, moving: bool = True) -> list[Said]:
    """So many frames, their depth 5 ms late, of a camera that goes along x at 1 m/s in `odom`, 1 m high."""
    found = [Said(INFO, seconds(0), info(WIDTH, HEIGHT, FRAME))]
    if moving:
        still = transforms((FRAME, "camera_link", (0.0, 0.0, 0.0)))
        found.append(Said("/tf_static", seconds(0), still))
    for n in range(count):
        at = seconds(n * apart_s)
        late = at + 5_000_000
        found.append(Said(COLOUR, at, image(RGB, "rgb8", stamp_ns=at, frame=FRAME)))
        found.append(Said(DEPTH, late, image(MM, "16UC1", stamp_ns=late, frame=FRAME)))
        if moving:
            link = ("camera_link", "odom", (n * apart_s, 0.0, 1.0))
            found.append(Said("/tf", at, transforms(link, stamp_ns=at)))
    return found


def instead(said: Iterable[Said], topic: str, change: Any, rename: str | None = None) -> list[Said]:
    """The same with other messages on a topic; None for none."""
    found = []
    for one in said:
        message = change(one.message) if one.topic == topic else one.message
        if message is not None:
            name = rename if rename is not None and one.topic == topic else one.topic
            found.append(Said(name, one.stamp_ns, message))
    return found


def compressed(message: Any, pixels: np.ndarray, said: str, kind: str = "PNG", header: bytes = b"") -> Any:
    """A `sensor_msgs/CompressedImage`."""
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, kind)
    data = np.frombuffer(header + buffer.getvalue(), np.uint8)
    return new("sensor_msgs/msg/CompressedImage", header=message.header, format=said, data=data)


def write(path: Path, kind: str, said: list[Said]) -> Path:
    """`bag`: ROS 1; `db3`, `rosbag2`: a folder of rosbag2; `mcap`, `mcap1`: a file for ROS 2 or 1."""
    match kind:
        case "bag":
            file = path / "table.bag"
            with Writer1(file) as writer:
                _fill(writer, said, ROS1, lambda m: ROS1.serialize_ros1(as_ros1(m), m.__msgtype__))
            return file
        case "db3" | "rosbag2":
            plugin = StoragePlugin.SQLITE3 if kind == "db3" else StoragePlugin.MCAP
            with Writer2(path / "table", version=9, storage_plugin=plugin) as writer:
                _fill(writer, said, store(), lambda m: store().serialize_cdr(m, m.__msgtype__))
            return path / "table"
        case "mcap" | "mcap1":
            file = path / "table.mcap"
            with file.open("wb") as stream:
                _fill_mcap(McapWriter(stream), said, ros1=kind == "mcap1")
            return file
    raise AssertionError(kind)


def _fill(writer: Any, said: list[Said], types: Any, encode: Any) -> None:
    known: dict[str, Any] = {}
    for topic, stamp_ns, message in sorted(said, key=lambda one: one.stamp_ns):
        if topic not in known:
            known[topic] = writer.add_connection(topic, message.__msgtype__, typestore=types)
        writer.write(known[topic], stamp_ns, encode(message))


def _fill_mcap(writer: McapWriter, said: list[Said], *, ros1: bool) -> None:
    types = ROS1 if ros1 else store()
    writer.start()
    known: dict[str, int] = {}
    for topic, stamp_ns, message in said:
        kind = message.__msgtype__
        if topic not in known:
            text, _ = types.generate_msgdef(kind, ros_version=1 if ros1 else 2)
            name = kind.replace("/msg/", "/") if ros1 else kind
            schema = writer.register_schema(name, "ros1msg" if ros1 else "ros2msg", text.encode())
            known[topic] = writer.register_channel(topic, "ros1" if ros1 else "cdr", schema)
        body = types.serialize_ros1(as_ros1(message), kind) if ros1 else types.serialize_cdr(message, kind)
        writer.add_message(known[topic], stamp_ns, bytes(body), stamp_ns)
    writer.finish()


def as_ros1(message: Any) -> Any:
    """The same message with the fields that ROS 1 gave it."""
    if isinstance(message, list):
        return [as_ros1(one) for one in message]
    if not hasattr(message, "__msgtype__"):
        return message
    names = [name for name, _ in ROS1.fielddefs[message.__msgtype__][1]]
    values = {
        name: as_ros1(getattr(message, name, getattr(message, name.lower(), None)) if name != "seq" else 0)
        for name in names
    }
    return ROS1.types[message.__msgtype__](**values)


def tum(folder: Path, count: int = 3, *, poses: bool = True) -> Path:
    """A folder as TUM's tools write it, its depth 5 ms late; the camera goes along x at 1 m/s."""
    for kind in ("rgb", "depth"):
        (folder / kind).mkdir(parents=True)
    lines: dict[str, list[str]] = {"rgb": ["# color images"], "depth": ["# depth maps"]}
    truth = ["# timestamp tx ty tz qx qy qz qw"]
    for n in range(count):
        for kind, pixels, late in (("rgb", RGB, 0.0), ("depth", MM * 5, 0.005)):
            stamp = f"{1305031102 + n * 0.1 + late:.6f}"
            Image.fromarray(pixels).save(folder / kind / f"{stamp}.png")
            lines[kind].append(f"{stamp} {kind}/{stamp}.png")
    for n in range(count + 1):
        truth.append(f"{1305031102 - 0.05 + n * 0.1:.4f} {n * 0.1 - 0.05:.4f} 0 1 0 0 0 1")
    for kind, said in lines.items():
        (folder / f"{kind}.txt").write_text("\n".join(said))
    if poses:
        (folder / "groundtruth.txt").write_text("\n".join(truth))
    return folder


def lens(path: Path, **more: float) -> Path:
    """A file of intrinsics for these pictures."""
    path.write_text(json.dumps({"fx": 100, "fy": 100, "cx": WIDTH / 2, "cy": HEIGHT / 2, **more}))
    return path
