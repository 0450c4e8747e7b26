"""Every key of the system, its message and its quality of service. No key is written anywhere else.

A prefix for one robot (`robot1/semmap/...`) is Zenoh's own `namespace` setting.
"""

from __future__ import annotations

import re
from functools import cache, lru_cache
from typing import Any, Literal, NamedTuple
from urllib.parse import quote, unquote

from semmap.schemas.commits import Commit, Effects
from semmap.schemas.frames import FramePose
from semmap.schemas.health import Health
from semmap.schemas.live import LivePose, LivePoses
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
"""Verbs of `CMD` that kb_node serves itself while it is ready: look-ups, for which the way is short."""

NODES = ("kb_node", "coordinator", "sim_node", "perception_node", "recorder")
"""The nodes that `semmap up` can start."""

WEB = "web"
"""The page, which `semmap up --web` starts beside the nodes; it is a client like any other."""

ROS = "ros"
"""The bridge that `semmap ros` runs beside the nodes; a client, too."""

CLIENTS = (WEB, ROS)
"""Clients whose hearts beat, too. Any number may run, and it is no fault when one has ended."""

ROUTER = "router"
"""The process that everybody, nodes included, is connected to under `semmap up --secure`."""


class Topic(NamedTuple):
    """A publication. `lossless` blocks rather than drops, and is recovered after a cut; else newest wins."""

    key: str
    message: Any
    qos: Literal["lossless", "newest"]


ACK = Topic(f"{ROOT}/ack", Ack, "lossless")
COMMIT = Topic(f"{ROOT}/jena/commit", Commit, "lossless")
EFFECTS = Topic(COMMIT.key, Effects, "lossless")
"""The same publication, read without its triples."""
COMMIT_EFFECTS = Topic(f"{ROOT}/jena/untold", Effects, "lossless")
"""The effects of the commits that no reply tells the coordinator of."""
ENTITY = Topic(f"{ROOT}/jena/entity/*/*", Described, "lossless")
QUERY = Topic(f"{ROOT}/jena/query/*", RowsChanged, "lossless")
POSES = Topic(f"{SIM}/poses", Poses, "newest")
CAMERA = Topic(f"{SIM}/camera/*/*", bytes, "newest")
SEGMENTS = Topic(f"{SIM}/camera/*/segments", bytes, "newest")
LIVE_POSE = Topic(f"{ROOT}/live/*", LivePose, "newest")
"""Of one tracked entity, by whoever knows where it is."""
LIVE_POSES = Topic(f"{ROOT}/live", LivePoses, "newest")
"""Of all tracked entities, by the coordinator."""
FRAME = Topic(f"{ROOT}/frame/**", FramePose, "newest")
"""Where a frame is in its parent, by whoever knows; a name with `/` has several chunks."""
OBSERVATIONS = Topic(f"{PERCEPTION}/observations", Observations, "newest")
CLOUD = Topic(f"{PERCEPTION}/cloud", SegmentedCloud, "newest")
DETECTIONS = Topic(f"{PERCEPTION}/detections", Observations, "newest")
"""What a detector of one's own has seen: perception compares it with the map as it does with what it sees."""
MASKS = Topic(f"{PERCEPTION}/masks", DetectedMasks, "newest")
"""What a 2-D detector of one's own has found in a camera's picture: perception cuts that up by it."""
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
    FRAME,
    CAMERA,
    OBSERVATIONS,
    CLOUD,
    DETECTIONS,
    MASKS,
    HEALTH,
)


def published() -> tuple[str, ...]:
    """Key expressions of all that is published, or put as a command, in whatever namespace."""
    commands = (CMD, f"{CMD}/*", f"{commands_as()}/*")
    return tuple(f"**/{key}" for key in (*(topic.key for topic in TOPICS), *commands))


def entity_key(class_name: str, name: str) -> str:
    """Where the state of one entity is published under one of its classes."""
    return f"{ROOT}/jena/entity/{_chunk(class_name)}/{_chunk(name)}"


def of_entity(key: str) -> tuple[str, str]:
    """The class and the name in the key of an entity."""
    class_chunk, name_chunk = key.split("/")[-2:]
    return unquote(class_chunk), unquote(name_chunk)


@lru_cache(10_000)
def _chunk(text: str) -> str:
    """`text` as one chunk of a key: what means something in a key is percent-escaped, letters are not."""
    return _RESERVED.sub(lambda match: quote(match[0], safe=""), text)


def query_key(watch: str) -> str:
    """Where the news of a standing query is published."""
    return f"{ROOT}/jena/query/{watch}"


def live_pose_key(name: str) -> str:
    """Where the live poses of one tracked entity are published."""
    return f"{ROOT}/live/{_chunk(name)}"


def of_live_pose(key: str) -> str:
    """The entity's name in such a key."""
    return unquote(last_chunk(key))


def frame_key(name: str) -> str:
    """Where a frame is published: `robot1/lidar` on `semmap/frame/robot1/lidar`."""
    return f"{ROOT}/frame/{'/'.join(map(_chunk, name.split('/')))}"


def of_frame(key: str) -> str:
    """The frame's name in such a key."""
    return unquote(key.partition(f"{ROOT}/frame/")[2])


def camera_key(camera: str, plane: Literal["rgb", "depth", "segments"]) -> str:
    """Where the raw planes of one camera are published; the attachment is a `CameraFrame`."""
    return f"{SIM}/camera/{camera}/{plane}"


def health_key(node: str) -> str:
    """Where a node's heartbeat is published."""
    return f"{ROOT}/health/{node}"


def live_key(node: str, instance: str = "*") -> str:
    """The liveliness token of one instance of a node; `**` does not match its `@` chunk."""
    return f"{ROOT}/@live/{node}/{instance}"


def robots_live(node: str = "*") -> str:
    """The liveliness tokens of a node of all robots that have a name, as a session without one sees them."""
    return f"*/{live_key(node)}"


def live_robot(key: str) -> str:
    """The robot of such a token's key."""
    return key.partition("/")[0]


@cache
def servers(prefix: str, verb: str) -> tuple[str, ...]:
    """The nodes that may answer `prefix/verb`."""
    prefix = served(prefix)
    first_hand = ("kb_node",) if prefix == CMD and verb in OF_THE_MAP else ()
    return first_hand + tuple(node for served, node in SERVED_BY.items() if served == prefix)


def commands_as(name: str = "*") -> str:
    """The prefix under which `name`, and nobody else, asks for commands when the system is secure."""
    return f"{_AS}/{name}/cmd"


def served(prefix: str) -> str:
    """`prefix` as one of `SERVED_BY`, whoever asks."""
    return CMD if prefix.startswith(f"{_AS}/") else prefix


def asked_as(key: str) -> str:
    """Who asks, by the key of a command: a name, or nothing where the key does not say."""
    chunks = key.split("/")
    return chunks[2] if len(chunks) > 2 and f"{chunks[0]}/{chunks[1]}" == _AS else ""


def recovery(key: str) -> str:
    """Where the two ends of a lossless topic find one another, and what was missed is recovered."""
    return f"{key}/@adv/**"


def live_node(key: str) -> str:
    """The node of a liveliness token's key."""
    return key.split("/")[-2]


def last_chunk(key: str) -> str:
    """The verb of a query's key, or the node of a heartbeat's."""
    return key.rsplit("/", 1)[-1]
