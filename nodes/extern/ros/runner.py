"""`semmap ros`: the map on ROS topics, and ROS cameras and detections for perception."""

from __future__ import annotations

import contextlib
import signal
from collections.abc import Callable, Iterator
from typing import Final

from msgspec import Struct

from semmap.nodes import bus
from semmap.nodes.bus.rmw import RosNode
from semmap.nodes.extern.ros.bridge import Bridge, topics
from semmap.nodes.extern.ros.cameras import CameraTopics
from semmap.nodes.extern.ros.inbound import Inbound
from semmap.nodes.runtime.loop import Node
from semmap.schemas import errors, keys

ROUTER: Final = "tcp/127.0.0.1:7447"
"""The default endpoint of the router of rmw_zenoh."""


class RosConfig(Struct, frozen=True, kw_only=True):
    """The settings; `frame` is the name of the map frame in ROS, and `rate_hz` the rate of transforms."""

    router: str = ROUTER
    domain: int = 0
    name: str = "semmap"
    frame: str = "map"
    rate_hz: float = 10.0
    meshes: bool = False
    planning_scene: str = "/planning_scene"
    cameras: tuple[CameraTopics, ...] = ()
    detections: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        names = [camera.name for camera in self.cameras]
        if len(set(names)) < len(names):
            raise errors.BadRequest("two cameras have the same name; use unique names")


def run(
    session: bus.Session,
    commands: str,
    config: RosConfig,
    tell: Callable[[str], None] = lambda _: None,
    connected: Callable[[], None] = lambda: None,
) -> None:
    """Run the bridge until stopped; `connected` is called once, when it has found the ROS router.

    Raises NoAnswer without a ROS router, BadRequest for a wrong endpoint.
    """
    node = Node(keys.ROS, session, commands)
    with ros_session(config.router) as other, _stop_on_signals(node.stop):
        connected()
        ros = RosNode(other, config.name, config.domain)
        Bridge(
            node,
            ros,
            topics(f"/{config.name}", config.planning_scene),
            frame=config.frame,
            meshes=config.meshes,
            period_s=1.0 / config.rate_hz,
            tell=tell,
        )
        Inbound(
            session,
            ros,
            frame=config.frame,
            cameras=config.cameras,
            detections=config.detections,
            tell=tell,
        )
        node.run()


@contextlib.contextmanager
def ros_session(router: str) -> Iterator[bus.Session]:
    """Open a Zenoh session in the network of ROS."""
    try:
        with bus.open_session(bus.Network(connect=(router,), mode="client")) as session:
            if not session.info.routers_zid():
                raise errors.BadRequest(
                    f"{router} is a Zenoh peer, not a router; start a router (ros2 run rmw_zenoh_cpp"
                    " rmw_zenohd), and set its endpoint with --router"
                )
            yield session
    except errors.NoAnswer:
        raise errors.NoAnswer(
            f"no response from a ROS router at {router}; start one (ros2 run rmw_zenoh_cpp rmw_zenohd), or"
            " set its endpoint with --router"
        ) from None


@contextlib.contextmanager
def _stop_on_signals(stop: Callable[[], None]) -> Iterator[None]:
    before = {number: signal.signal(number, lambda *_: stop()) for number in (signal.SIGTERM, signal.SIGINT)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
