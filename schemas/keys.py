"""All keys of the system, with their message types and quality of service. Other modules write no keys.

The prefix of a robot (`robot1/semmap/...`) is Zenoh's `namespace` setting.
"""

from __future__ import annotations

import re
from functools import cache, lru_cache
from typing import Any, Literal, NamedTuple
from urllib.parse import quote, unquote

from semmap.schemas.commits import Commit, Effects
from semmap.schemas.frames import FramePose
from semmap.schemas.health import Health
from semmap.schemas.live import LivePose, LivePoses, RobotState
from semmap.schemas.perception import DetectedMasks, Observations, SegmentedCloud
from semmap.schemas.relations import Described
from semmap.schemas.replies import Ack
from semmap.schemas.scenes import Poses
from semmap.schemas.sparql import RowsChanged

ROOT = "semmap"
_RESERVED = re.compile(r"[/*$?#%@\s]")

# Queries: <prefix>/<verb>
CMD = f"{ROOT}/cmd"
BRIDGE = f"{ROOT}/bridge"
SIM = f"{ROOT}/sim"
PERCEPTION = f"{ROOT}/perception"
SERVED_BY = {CMD: "coordinator", BRIDGE: "kb_node", SIM: "sim_node", PERCEPTION: "perception_node"}

_AS = f"{ROOT}/as"

OF_THE_MAP = frozenset({"sparql"})
"""Commands that kb_node serves directly while it is ready, to shorten the path of queries."""

NODES = ("kb_node", "coordinator", "sim_node", "perception_node", "recorder")
"""The nodes that `semmap up` can start."""

WEB = "web"
"""The web page, a client that `semmap up --web` starts."""

ROS = "ros"
"""The ROS bridge, a client that `semmap ros` starts."""

CLIENTS = (WEB, ROS)
"""Clients that publish heartbeats. Any number can run, and it is not a fault if one ends."""

ROUTER = "router"
"""The process that all nodes and clients connect to under `semmap up --secure`."""


class Topic(NamedTuple):
    """A published key. `lossless` blocks instead of dropping and is recovered after a disconnection."""

    key: str
    message: Any
    qos: Literal["lossless", "newest"]


ACK = Topic(f"{ROOT}/ack", Ack, "lossless")
COMMIT = Topic(f"{ROOT}/jena/commit", Commit, "lossless")
EFFECTS = Topic(COMMIT.key, Effects, "lossless")
"""The same publication, decoded without its triples."""
COMMIT_EFFECTS = Topic(f"{ROOT}/jena/untold", Effects, "lossless")
"""The effects of commits that the coordinator does not get in a reply."""
ENTITY = Topic(f"{ROOT}/jena/entity/*/*", Described, "lossless")
QUERY = Topic(f"{ROOT}/jena/query/*", RowsChanged, "lossless")
POSES = Topic(f"{SIM}/poses", Poses, "newest")
CAMERA = Topic(f"{SIM}/camera/*/*", bytes, "newest")
SEGMENTS = Topic(f"{SIM}/camera/*/segments", bytes, "newest")
LIVE_POSE = Topic(f"{ROOT}/live/*", LivePose, "newest")
"""The pose of one tracked entity, from any publisher."""
LIVE_POSES = Topic(f"{ROOT}/live", LivePoses, "newest")
"""The poses of all tracked entities, published by the coordinator."""
ROBOT_STATE = Topic(f"{ROOT}/robot/*", RobotState, "newest")
"""The base and the joints of one robot, from the simulator or any publisher."""
FRAME = Topic(f"{ROOT}/frame/**", FramePose, "newest")
"""The pose of a frame in its parent, from any publisher; a name with `/` has several chunks."""
OBSERVATIONS = Topic(f"{PERCEPTION}/observations", Observations, "newest")
CLOUD = Topic(f"{PERCEPTION}/cloud", SegmentedCloud, "newest")
DETECTIONS = Topic(f"{PERCEPTION}/detections", Observations, "newest")
"""Detections of an external detector, which perception compares with the map like its own."""
MASKS = Topic(f"{PERCEPTION}/masks", DetectedMasks, "newest")
"""Masks of an external 2-D detector, by which perception segments the camera image."""
HEALTH = Topic(f"{ROOT}/health/*", Health, "newest")

TOPICS = (
    ACK,
    COMMIT,
    COMMIT_EFFECTS,
    ENTITY,
    QUERY,
    POSES,
    LIVE_POSE,
    LIVE_POSES,
    ROBOT_STATE,
    FRAME,
    CAMERA,
    OBSERVATIONS,
    CLOUD,
    DETECTIONS,
    MASKS,
    HEALTH,
)


def published() -> tuple[str, ...]:
    """Return the key expressions of all publications and put commands, in any namespace."""
    commands = (CMD, f"{CMD}/*", f"{commands_as()}/*")
    return tuple(f"**/{key}" for key in (*(topic.key for topic in TOPICS), *commands))


def entity_key(class_name: str, name: str) -> str:
    """Return the key on which an entity's state is published under one of its classes."""
    return f"{ROOT}/jena/entity/{_chunk(class_name)}/{_chunk(name)}"


def of_entity(key: str) -> tuple[str, str]:
    """Return the class and the name in the key of an entity."""
    class_chunk, name_chunk = key.split("/")[-2:]
    return unquote(class_chunk), unquote(name_chunk)


@lru_cache(10_000)
def _chunk(text: str) -> str:
    """Return `text` as one chunk of a key: special characters are percent-escaped, letters are not."""
    return _RESERVED.sub(lambda match: quote(match[0], safe=""), text)


def query_key(watch: str) -> str:
    """Return the key on which the changes of a standing query are published."""
    return f"{ROOT}/jena/query/{watch}"


def live_pose_key(name: str) -> str:
    """Return the key on which the live poses of one tracked entity are published."""
    return f"{ROOT}/live/{_chunk(name)}"


def of_live_pose(key: str) -> str:
    """Return the entity's name in such a key."""
    return unquote(last_chunk(key))


def robot_state_key(name: str) -> str:
    """Return the key on which the states of one robot are published."""
    return f"{ROOT}/robot/{_chunk(name)}"


def frame_key(name: str) -> str:
    """Return the key of a frame: `semmap/frame/robot1/lidar` for `robot1/lidar`."""
    return f"{ROOT}/frame/{'/'.join(map(_chunk, name.split('/')))}"


def of_frame(key: str) -> str:
    """Return the frame's name in such a key."""
    return unquote(key.partition(f"{ROOT}/frame/")[2])


def camera_key(camera: str, plane: Literal["rgb", "depth", "segments"]) -> str:
    """Return the key of a camera's raw planes; the attachment of a sample is a `CameraFrame`."""
    return f"{SIM}/camera/{camera}/{plane}"


def health_key(node: str) -> str:
    """Return the key of a node's heartbeats."""
    return f"{ROOT}/health/{node}"


def live_key(node: str, instance: str = "*") -> str:
    """Return the liveliness token of one instance of a node; `**` does not match its `@` chunk."""
    return f"{ROOT}/@live/{node}/{instance}"


def session_key(instance: str = "*") -> str:
    """Return the liveliness token of a session, by which nodes detect that a client has gone."""
    return f"{ROOT}/@session/{instance}"


def robots_live(node: str = "*") -> str:
    """Return the liveliness tokens of a node of all named robots, for a session without a namespace."""
    return f"*/{live_key(node)}"


def live_robot(key: str) -> str:
    """Return the robot in such a token's key."""
    return key.partition("/")[0]


@cache
def servers(prefix: str, verb: str) -> tuple[str, ...]:
    """Return the nodes that can serve `prefix/verb`."""
    prefix = served(prefix)
    direct = ("kb_node",) if prefix == CMD and verb in OF_THE_MAP else ()
    return direct + tuple(node for served, node in SERVED_BY.items() if served == prefix)


def commands_as(name: str = "*") -> str:
    """Return the command prefix of the identity `name` in a secure system; only it has access."""
    return f"{_AS}/{name}/cmd"


def served(prefix: str) -> str:
    """Return the prefix in `SERVED_BY`, without the identity."""
    return CMD if prefix.startswith(f"{_AS}/") else prefix


def asked_as(key: str) -> str:
    """Return the identity in the key of a command, or an empty text if it has none."""
    chunks = key.split("/")
    return chunks[2] if len(chunks) > 2 and f"{chunks[0]}/{chunks[1]}" == _AS else ""


def recovery(key: str) -> str:
    """Return the key expression by which advanced subscribers of a lossless topic recover missed samples."""
    return f"{key}/@adv/**"


def live_node(key: str) -> str:
    """Return the node in a liveliness token's key."""
    return key.split("/")[-2]


def last_chunk(key: str) -> str:
    """Return the command in a query's key, or the node in a heartbeat's."""
    return key.rsplit("/", 1)[-1]
