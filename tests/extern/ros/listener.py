"""A ROS 2 node by zenoh-ros2-sdk, in a process of its own: `python -m tests.extern.ros.listener PORT`.

It says what it hears, a JSON line a message; each line that it reads is a camera's frame to publish.
"""

from __future__ import annotations

import json
import sys
import threading
from typing import Any

import numpy as np
from rosbags.typesys import get_types_from_msg
from zenoh_ros2_sdk import ROS2Publisher, ROS2Subscriber
from zenoh_ros2_sdk.qos import QosDurability, QosProfile
from zenoh_ros2_sdk.session import ZenohSession

from semmap.nodes.extern.ros.bridge import topics
from semmap.nodes.extern.ros.types import store
from tests.extern.ros.made import image, info, transforms

PORT = int(sys.argv[1])
SAYING = threading.Lock()


def known(type_name: str) -> dict[str, Any]:
    """The SDK knows a type, and those in it; what its publishers and subscribers need besides."""
    text, _ = store().generate_msgdef(type_name, ros_version=2)
    theirs = ZenohSession.get_instance("127.0.0.1", PORT).store
    for name, definition in get_types_from_msg(text, type_name).items():
        if name not in theirs.fielddefs:
            theirs.register({name: definition})
    return {
        "msg_type": type_name,
        "msg_definition": text.partition("=" * 80)[0],
        "type_hash": store().hash_rihs01(type_name),
        "router_ip": "127.0.0.1",
        "router_port": PORT,
    }


def say(name: str, what: list[Any]) -> None:
    """One line, whole, whichever thread says it."""
    with SAYING:
        print(json.dumps([name, what]), flush=True)


def subscribe(name: str, type_name: str, read: Any, *, latched: bool = False) -> ROS2Subscriber:
    """Say of each message what `read` gives."""
    qos = QosProfile(durability=QosDurability.TRANSIENT_LOCAL, history_depth=1) if latched else None
    return ROS2Subscriber(topic=name, callback=lambda m: say(name, read(m)), qos=qos, **known(type_name))


def detected(message: Any) -> list[Any]:
    """Names with their classes."""
    return [[d.id, d.results[0].hypothesis.class_id] for d in message.detections]


def transformed(message: Any) -> list[Any]:
    """Frames; of those that are in another than the map's, that as well: `parent>child`."""
    told = [(t.header.frame_id, t.child_frame_id) for t in message.transforms]
    return [child if parent == "map" else f"{parent}>{child}" for parent, child in told]


def gridded(message: Any) -> list[Any]:
    """Its size, and what its cells may be."""
    return [message.info.width, message.info.height, sorted(set(message.data.tolist()))]


def main() -> None:
    """Listen until standard input ends."""
    of = topics()
    _kept = [
        subscribe(of.detections.name, of.detections.type, detected),
        subscribe("/latched", of.detections.type, detected, latched=True),
        subscribe(of.grid.name, of.grid.type, gridded),
        subscribe(of.markers.name, of.markers.type, lambda m: [k.text for k in m.markers]),
        subscribe(of.transforms.name, of.transforms.type, transformed),
        subscribe(
            of.planning_scene.name,
            of.planning_scene.type,
            lambda m: [[o.id, o.operation] for o in m.world.collision_objects],
        ),
    ]
    image_type = "sensor_msgs/msg/Image"
    publishers = {
        name: ROS2Publisher(topic=name, **known(kind))
        for name, kind in (
            ("/tf_static", "tf2_msgs/msg/TFMessage"),
            ("/a/info", "sensor_msgs/msg/CameraInfo"),
            ("/a/color", image_type),
            ("/a/depth", image_type),
        )
    }
    say("ready", [])
    colour = np.arange(4 * 6 * 3, dtype=np.uint8).reshape(4, 6, 3)
    for stamp_ns in map(int, sys.stdin):
        for name, message in (
            ("/tf_static", transforms(("lens", "map", (0.0, 0.0, 1.0)))),
            ("/a/info", info(6, 4)),
            ("/a/color", image(colour[:, :, ::-1], "bgr8", stamp_ns=stamp_ns)),
            ("/a/depth", image(np.full((4, 6), 1500, np.uint16), "16UC1", stamp_ns=stamp_ns)),
        ):
            fields = {f: getattr(message, f) for f in message.__dataclass_fields__ if f != "__msgtype__"}
            publishers[name].publish(**fields)


if __name__ == "__main__":
    main()
