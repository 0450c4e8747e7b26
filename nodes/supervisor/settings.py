"""The settings of `semmap up`. They are written to a file that each node's process reads."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Annotated, Literal

import platformdirs
from msgspec import Meta, Struct, structs

from semmap.nodes.bus import DEFAULT_ENDPOINT, FOREVER_S, Network, is_local
from semmap.nodes.identity import Identity
from semmap.schemas.endpoints import ALL_ROBOTS, robot_name
from semmap.schemas.entities import Angle, Metres, Name
from semmap.schemas.errors import BadRequest
from semmap.schemas.keys import ROUTER, WEB

_LIMIT = re.compile("[1-9][0-9]{0,5}(h|d|MB|GB)")
ANY_PORT = "tcp/127.0.0.1:0"
SETTINGS = "settings.json"
"""The file of the settings in the data folder."""
JOURNAL = "journal.sqlite"
"""The file of the journal there: where it is, there is a map to go on with."""


def default_data() -> Path:
    """Where the map is kept when nothing else is said."""
    return platformdirs.user_data_path("semmap")


class Replay(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Which commits of another map are replayed, and how fast."""

    of: str
    """The data folder of that map."""
    since: int
    """The commit after which the replay begins."""
    until: int
    speed: float
    longest_s: float
    """No wait between two commits is longer."""


class Settings(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """All settings of a system. Paths are absolute."""

    data: str
    tbox: str | tuple[str, ...]
    """The TBox's file, or its files and folders."""
    imports: dict[str, str] = {}
    """In which file an ontology is that the TBox imports, where it is not found by itself."""
    spatial_root: tuple[str, ...] = ()
    """Classes of the TBox whose instances are things in space, where that is not known by itself."""
    abox: str | None
    """None is an empty map."""
    world: str
    truth: Literal["map", "scene", "perceived", "replayed"] = "map"
    threshold_m: Annotated[float, Meta(gt=0.0)] = 0.05
    angle_threshold_deg: Annotated[float, Meta(gt=0.0, le=180.0)] = 5.0
    robot: str | None = None
    """The MJCF file of a robot in the world."""
    robot_name: Name = "robot1"
    robot_at: tuple[Metres, Metres, Metres] | None = None
    """Where it stands at first, if that was said; otherwise it begins at the origin."""
    robot_yaw: Angle = 0.0
    stale_s: Annotated[float, Meta(gt=0.0, le=86_400.0)] = 2.0
    """After how long a live pose that is not followed by another is stale."""
    journal_every_s: Annotated[float, Meta(ge=0.0, le=86_400.0)] = 0.0
    """How often the live poses of what moves are committed; 0 is only where it stops."""
    listen: str = DEFAULT_ENDPOINT
    connect: tuple[str, ...] = ()
    only: tuple[str, ...] = ()
    """The nodes that run on this host, when others run elsewhere; empty is a whole system."""
    single: bool = False
    """One node in the foreground: it joins what is there, and has no router of its own."""
    sim: bool = True
    record: bool = True
    record_keep: str | None = None
    """How much is kept of the recordings, by age or size; None is everything."""
    fresh: bool = False
    window: bool = False
    models: str | None = None
    """Folder of a person's own model files."""
    camera_hz: Annotated[float, Meta(ge=0.0, le=60.0)] = 0.0
    camera_size: tuple[Annotated[int, Meta(ge=16, le=4096)], Annotated[int, Meta(ge=16, le=4096)]] = (
        640,
        480,
    )
    camera_noise: bool = False
    perception: bool = False
    when_gone: Literal["remove", "mark"] = "remove"
    """What becomes of an entity that perception brought in and no longer sees."""
    label_map: dict[str, str] = {}
    """From the labels of a detector of a person's own to classes."""
    web: bool = False
    """The page runs beside the nodes."""
    web_port: Annotated[int, Meta(ge=0, le=65_535)] = 8080
    web_as: str = ""
    """With `secure`: the name of the certificate under whose role the page acts."""
    live_view: str | None = None
    """Where the recorder streams to Rerun viewers, `host:port`."""
    secure: str | None = None
    """The folder of keys: everybody, nodes included, shows a certificate to the router, the one listener of
    this host."""
    namespace: str = ""
    """The name of the robot, which prefixes every key: several robots can share a network.

    Of a single router that robots share it is `*`.
    """
    replay: Replay | None = None
    """The map replays the past, and nobody changes it; then `truth` is `replayed`."""
    zenoh_config: str | None = None
    """A Zenoh configuration file of one's own, for every process of the system."""

    def __post_init__(self) -> None:
        """Raises ValueError for settings that make no sense, by themselves or together."""
        if self.record_keep is not None and not _LIMIT.fullmatch(self.record_keep):
            raise ValueError(
                f"--record-keep: '{self.record_keep}' is neither an age nor a size; examples: 12h, 7d, 500MB,"
                " 20GB"
            )
        try:
            robot_name("" if self.single and self.namespace == ALL_ROBOTS else self.namespace)
        except BadRequest as error:
            raise ValueError(error.text) from None
        if self.robot is not None and not self.sim and not self.only:
            raise ValueError("--robot puts a robot into the simulator; leave out --no-sim")
        for endpoint in (self.listen, *self.connect):
            if not is_endpoint(endpoint):
                raise ValueError(f"'{endpoint}' is not a valid Zenoh endpoint; example: {DEFAULT_ENDPOINT}")
        decides = not self.only or "coordinator" in self.only  # else another host says what the truth is
        if decides and self.perception and self.sim and self.camera_hz and self.truth != "perceived":
            raise ValueError(
                f"with --truth {self.truth} the simulator's cameras only show what the map already says, so"
                " perception cannot use them; add --truth perceived, or --camera-hz 0 to use other"
                " cameras"
            )

    @property
    def tboxes(self) -> tuple[Path, ...]:
        """The files and folders of the TBox."""
        return tuple(map(Path, (self.tbox,) if isinstance(self.tbox, str) else self.tbox))

    @property
    def nodes(self) -> tuple[str, ...]:
        """The nodes to run, in the order of starting, and the page after them."""
        optional = {"sim_node": self.sim, "recorder": self.record, "perception_node": self.perception}
        order = ("coordinator", "kb_node", "sim_node", "recorder", "perception_node")
        router = (ROUTER,) if self.has_router else ()
        page = (WEB,) if self.web else ()
        if self.only:
            return router + tuple(node for node in order if node in self.only) + page
        return router + tuple(node for node in order if optional.get(node, True)) + page

    @property
    def has_router(self) -> bool:
        """Do the nodes of this host meet at a router, which alone talks to other hosts?

        So it is wherever somebody may come from elsewhere, and where certificates have to be shown.
        """
        elsewhere = not all(map(is_local, (self.listen, *self.connect)))
        return self.secure is not None or bool(self.only) or elsewhere

    @property
    def angle_threshold_rad(self) -> float:
        """The angle threshold in radians."""
        return math.radians(self.angle_threshold_deg)

    def network(self, node: str) -> Network:
        """The coordinator listens where the world expects it; the others connect to it and mesh by gossip.

        Where there is a router it listens, and all others are its clients; it connects to other hosts. A
        single node is a client of whoever listens there.
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
        if node == WEB:  # which nobody's messages are to go through, and which must hold up nobody
            return Network(connect=(self.reachable,), patience_s=FOREVER_S)
        if node == "coordinator":
            return Network(mode="peer", listen=(self.listen,), connect=self.connect)
        return Network(mode="peer", listen=(ANY_PORT,), connect=(self.reachable, *self.connect))

    def identity_of(self, node: str) -> Identity:
        """The certificate that a node shows; the page shows that of whom it acts for. Raises BadFile."""
        return Identity.read(Path(self.secure or "") / ((self.web_as or WEB) if node == WEB else node))

    @property
    def reachable(self) -> str:
        """The endpoint at which programs of this machine reach the system."""
        return self.listen.replace("/0.0.0.0:", "/127.0.0.1:").replace("/[::]:", "/[::1]:")


def is_endpoint(text: str) -> bool:
    """Is it a protocol and an address, with a port that there can be, if with one?"""
    protocol, _, address = text.partition("/")
    port = address.rpartition(":")[2]
    return bool(protocol and address) and (not port.isdecimal() or int(port) < 1 << 16)
