"""The settings of `semmap up`, which are written to a file that each node's process reads."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Annotated, Literal

import platformdirs
from msgspec import Meta, Struct, structs

from semmap.nodes.bus import DEFAULT_ENDPOINT, FOREVER_S, Network, is_local
from semmap.nodes.identity import Identity
from semmap.schemas.endpoints import ALL_ROBOTS, parse_endpoint, robot_name
from semmap.schemas.entities import Metres, Name, Radians
from semmap.schemas.errors import BadRequest
from semmap.schemas.keys import ROUTER, WEB
from semmap.schemas.perception import LEAST_SCORE

_LIMIT = re.compile("[1-9][0-9]{0,5}(h|d|MB|GB)")
ANY_PORT = "tcp/127.0.0.1:0"
SETTINGS = "settings.json"
"""The settings file in the data folder."""
JOURNAL = "journal.sqlite"
"""The journal in the data folder; if it exists, its map is continued."""


def default_data() -> Path:
    """Return the default data folder."""
    return platformdirs.user_data_path("semmap")


class Replay(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The range and speed of a replay of another map."""

    of: str
    """The data folder of that map."""
    since: int
    """The commit after which the replay begins."""
    until: int
    speed: float
    longest_s: float
    """Longest wait between two commits."""


class Settings(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """All settings of a system. Paths are absolute."""

    data: str
    started_ns: int = 0
    """When the system was started; its recording begins with the first commit since then."""
    tbox: str | tuple[str, ...]
    """The file of the TBox, or its files and folders."""
    imports: dict[str, str] = {}
    """Files of imported ontologies that are not found automatically, by IRI."""
    spatial_root: tuple[str, ...] = ()
    """Classes of the TBox whose instances are spatial, where that is not known automatically."""
    abox: str | None
    """None for an empty map."""
    skip_unknown: bool = False
    """Whether individuals of the ABox file whose classes are unknown are left out."""
    tbox_from_abox: bool = False
    """Whether the classes and properties that the ABox file declares become part of the TBox."""
    enforce_shapes: bool = False
    """Whether commits that violate a SHACL shape of the TBox are rejected."""
    world: str
    truth: Literal["map", "scene", "perceived", "replayed"] = "map"
    threshold_m: Annotated[float, Meta(gt=0.0)] = 0.05
    angle_threshold_deg: Annotated[float, Meta(gt=0.0, le=180.0)] = 5.0
    robot: str | None = None
    """The MJCF file of a robot in the world."""
    robot_name: Name = "robot1"
    robot_at: tuple[Metres, Metres, Metres] | None = None
    """Its initial position, if given; otherwise the origin, or in the shipped flat a free place."""
    robot_yaw: Radians = 0.0
    stale_s: Annotated[float, Meta(gt=0.0, le=86_400.0)] = 2.0
    """Seconds after which a live pose is stale."""
    journal_every_s: Annotated[float, Meta(ge=0.0, le=86_400.0)] = 0.0
    """Interval of commits of moving entities; 0 commits them only at rest."""
    listen: str = DEFAULT_ENDPOINT
    connect: tuple[str, ...] = ()
    only: tuple[str, ...] = ()
    """The nodes on this host, if others run elsewhere; empty for a whole system."""
    single: bool = False
    """A single node in the foreground, which joins a running system and has no router."""
    sim: bool = True
    record: bool = True
    record_keep: str | None = None
    """Limit of the recordings by age or size; None keeps all."""
    fresh: bool = False
    reset_world: bool = False
    """Whether the bodies begin as in the world file, and not where they last stood."""
    window: bool = False
    models: str | None = None
    """Folder of the user's model files."""
    camera_hz: Annotated[float, Meta(ge=0.0, le=60.0)] = 0.0
    camera_size: tuple[Annotated[int, Meta(ge=16, le=4096)], Annotated[int, Meta(ge=16, le=4096)]] = (
        640,
        480,
    )
    camera_noise: bool = False
    perception: bool = False
    when_gone: Literal["remove", "mark"] = "remove"
    """What to do with an entity that perception added and no longer sees."""
    class_map: dict[str, str] = {}
    """Maps names of bodies of the world file to classes."""
    label_map: dict[str, str] = {}
    """Maps labels of a detector to classes."""
    detector: str | None = None
    """The file of a detector's model, which perception runs on colour images."""
    detector_names: str | None = None
    """The file with the names of its classes, or `coco`; None for those in the model."""
    detector_layout: str = ""
    """The layout of its outputs; empty to recognise it."""
    detector_score: Annotated[float, Meta(ge=0.0, le=1.0)] = LEAST_SCORE
    """The minimum score of its detections."""
    mask_robot: str | None = None
    """The MJCF or URDF file of the robot `mask_robot_name`, which perception leaves out of frames."""
    mask_robot_name: Name = "robot1"
    web: bool = False
    """Whether the web page runs beside the nodes."""
    web_port: Annotated[int, Meta(ge=0, le=65_535)] = 8080
    web_as: str = ""
    """With `secure`: the name of the certificate whose role the page uses."""
    live_view: str | None = None
    """The address `host:port` at which the recorder streams to Rerun viewers."""
    secure: str | None = None
    """The folder of keys: all clients and nodes show a certificate to the router, the only listener of this
    host."""
    namespace: str = ""
    """The name of the robot, which prefixes every key so that several robots can share a network.

    It is `*` for a single router that robots share.
    """
    replay: Replay | None = None
    """The map replays the past and is read-only; then `truth` is `replayed`."""
    zenoh_config: str | None = None
    """The user's Zenoh configuration file for all processes of the system."""

    def __post_init__(self) -> None:
        """Raise ValueError for invalid settings and combinations."""
        if self.record_keep is not None and not _LIMIT.fullmatch(self.record_keep):
            raise ValueError(
                f"--record-keep: invalid age or size '{self.record_keep}'; examples: 12h, 7d, 500MB, 20GB"
            )
        try:
            robot_name("" if self.single and self.namespace == ALL_ROBOTS else self.namespace)
        except BadRequest as error:
            raise ValueError(error.text) from None
        if self.robot is not None and not self.sim and not self.only:
            raise ValueError("--robot requires the simulator; remove --no-sim")
        for endpoint in (self.listen, *self.connect):
            try:
                parse_endpoint(endpoint)
            except BadRequest as error:
                raise ValueError(error.text) from None
        decides = not self.only or "coordinator" in self.only  # otherwise another host defines the truth
        if decides and self.perception and self.sim and self.camera_hz and self.truth != "perceived":
            raise ValueError(
                f"with --truth {self.truth} the simulator's cameras only show the content of the map, so"
                " perception cannot use them; add --truth perceived, or use other cameras with --camera-hz 0"
            )

    @property
    def tboxes(self) -> tuple[Path, ...]:
        """The files and folders of the TBox."""
        return tuple(map(Path, (self.tbox,) if isinstance(self.tbox, str) else self.tbox))

    @property
    def nodes(self) -> tuple[str, ...]:
        """The nodes to run in the order of their start, and then the page."""
        optional = {"sim_node": self.sim, "recorder": self.record, "perception_node": self.perception}
        order = ("coordinator", "kb_node", "sim_node", "recorder", "perception_node")
        router = (ROUTER,) if self.has_router else ()
        page = (WEB,) if self.web else ()
        if self.only:
            return router + tuple(node for node in order if node in self.only) + page
        return router + tuple(node for node in order if optional.get(node, True)) + page

    @property
    def has_router(self) -> bool:
        """Whether the nodes of this host connect through a router, which alone connects to other hosts.

        This is the case if clients may connect from elsewhere, or if certificates are required.
        """
        elsewhere = not all(map(is_local, (self.listen, *self.connect)))
        return self.secure is not None or bool(self.only) or elsewhere

    @property
    def angle_threshold_rad(self) -> float:
        """The angle threshold in radians."""
        return math.radians(self.angle_threshold_deg)

    def network(self, node: str) -> Network:
        """Return the network settings of a node.

        Without a router, the coordinator listens at the public endpoint, and the others connect to it and
        form a mesh. With a router, the router listens and connects to other hosts, and all others are its
        clients. A single node is a client of the running system.
        """
        namespace = "" if self.namespace == ALL_ROBOTS else self.namespace
        return structs.replace(self._place(node), namespace=namespace, own_config=self.zenoh_config)

    def _place(self, node: str) -> Network:
        identity = None if self.secure is None else self.identity_of(node)
        if node == ROUTER:
            return Network(mode="router", listen=(self.listen,), connect=self.connect, identity=identity)
        if self.has_router:
            where = self.connect if self.single and self.connect else (self.reachable,)
            return Network(connect=where, identity=identity, patience_s=FOREVER_S)
        if node == WEB:  # not a peer: no messages are routed through it, and it must not delay others
            return Network(connect=(self.reachable,), patience_s=FOREVER_S)
        if node == "coordinator":
            return Network(mode="peer", listen=(self.listen,), connect=self.connect)
        return Network(mode="peer", listen=(ANY_PORT,), connect=(self.reachable, *self.connect))

    def identity_of(self, node: str) -> Identity:
        """Return the identity of a node; the page uses that of the client it acts for. Raises BadFile."""
        return Identity.read(Path(self.secure or "") / ((self.web_as or WEB) if node == WEB else node))

    @property
    def reachable(self) -> str:
        """The endpoint at which programs on this machine reach the system."""
        return self.listen.replace("/0.0.0.0:", "/127.0.0.1:").replace("/[::]:", "/[::1]:")
