"""The map on ROS topics: the bridge subscribes to the map and its poses, and publishes the changes."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from typing import Any, Final, NamedTuple

from semmap.nodes.bus.rmw import RosNode, RosPublisher, RosTopic
from semmap.nodes.drawing.scene_state import SceneState
from semmap.nodes.drawing.surfaces import Kind, SurfaceCache
from semmap.nodes.extern.ros import messages
from semmap.nodes.extern.ros.messages import Moment
from semmap.nodes.extern.ros.planning_scene import follow_scene, forget_scene, planning_scene
from semmap.nodes.extern.ros.published_frames import Placed, PublishedFrames
from semmap.nodes.extern.ros.shapes import ShapeFeed
from semmap.nodes.extern.ros.things import Thing, located_things
from semmap.nodes.extern.ros.types import encode, topic
from semmap.nodes.navigation.grid import occupancy
from semmap.nodes.runtime.loop import Node
from semmap.nodes.runtime.map_follower import Follower
from semmap.nodes.runtime.map_replica import MapReplica
from semmap.schemas import keys
from semmap.schemas.commands import PlanFloor
from semmap.schemas.commits import Effects
from semmap.schemas.entities import Pose
from semmap.schemas.live import LivePoses
from semmap.schemas.plans import HEIGHTS_M, Plan
from semmap.schemas.scenes import Poses, Scene, SceneQuery, Surface, SurfaceQuery, Surfaces

_TICK_S: Final = 0.05
_AGAIN_S: Final = 1.0
"""The period of transforms of static objects, because listeners drop old transforms."""
_WHOLE_S: Final = 0.5
"""The minimum period of detections, markers and the planning scene."""
_GREETING_S: Final = (0.0, 1.0, 4.0)
_FLOOR_S: Final = 2.0
_CELL_M: Final = 0.05
_SURFACES_AT_ONCE: Final = 50
_RETRY_S: Final = 2.0
"""Time after which surfaces that did not arrive are requested again."""


class Topics(NamedTuple):
    """The topics of the map. Names begin with a slash."""

    detections: RosTopic
    markers: RosTopic
    transforms: RosTopic
    planning_scene: RosTopic
    grid: RosTopic


def topics(prefix: str = "/semmap", planning_scene: str = "/planning_scene") -> Topics:
    """Return the topics: detections, markers and grid are latched; the others have the usual names of ROS."""
    return Topics(
        detections=topic(f"{prefix}/detections", "vision_msgs/msg/Detection3DArray", latched=True),
        markers=topic(f"{prefix}/markers", "visualization_msgs/msg/MarkerArray", latched=True),
        transforms=topic("/tf", "tf2_msgs/msg/TFMessage"),
        planning_scene=topic(planning_scene, "moveit_msgs/msg/PlanningScene"),
        grid=topic(f"{prefix}/map", "nav_msgs/msg/OccupancyGrid", latched=True),
    )


class Bridge:
    """Publishes the map on ROS topics. It is owned by the thread of the node."""

    def __init__(
        self,
        node: Node,
        ros: RosNode,
        of: Topics,
        *,
        frame: str = "map",
        meshes: bool = False,
        period_s: float = 0.1,
        tell: Callable[[str], None] = lambda _: None,
    ) -> None:
        """`frame` is the name of the map frame in ROS; transforms are published every `period_s`."""
        self._node, self._frame, self._period_s, self._tell = node, frame, period_s, tell
        self._map = MapReplica[Effects]()
        self._scene = SceneState()
        self._fetching = False
        self._floor_differs, self._asking_floor = True, False
        self._live: dict[str, Pose] = {}
        self._surfaces: SurfaceCache | None = SurfaceCache() if meshes else None
        self._shapes = ShapeFeed(node, self._mark_changed)
        self._things: dict[str, Thing] = {}
        self._is_stale = True
        self._published: dict[str, Thing] | None = None
        self._planned: dict[str, Thing] = {}
        self._transformed: dict[str, Thing] = {}
        self._frames = PublishedFrames(node, self._map)
        self._published_frames: Mapping[str, Placed] = {}
        self._due_s = dict.fromkeys(("whole", "transforms", "again", "floor"), 0.0)
        self._publishers: dict[RosTopic, RosPublisher] = {made: ros.publish(made) for made in of}
        self._topics = of
        Follower(
            node,
            self._map,
            keys.EFFECTS,
            on_commit=lambda _, __: self._mark_changed(),
            on_snapshot=self._on_snapshot,
            classes_at=keys.CMD,  # the role viewer also has this permission
        )
        node.follow_newest(keys.POSES, self._on_poses)
        node.follow_newest(keys.LIVE_POSES, self._on_live)
        ros.when_subscribed(of.planning_scene, lambda: node.soon(self._on_subscriber))
        node.every(_TICK_S, self._tick)

    # Subscriptions

    def _on_snapshot(self, _: Any) -> None:
        self._shapes.reset()
        self._mark_changed()
        self._tell(f"publishing {len(self._map.entities)} entities as of commit {self._map.seq}")
        self._node.ready("publishing to ROS")

    def _mark_changed(self) -> None:
        self._is_stale = True

    def _on_poses(self, poses: Poses) -> None:
        if not self._scene.matches(poses):
            self._fetch_scene()
        elif any(self._scene.follow(poses)):
            self._mark_changed()

    def _on_live(self, live: LivePoses) -> None:
        self._live = {name: entity.pose for name, entity in live.entities.items()}
        self._mark_changed()

    def _fetch_scene(self) -> None:
        if self._fetching:
            return
        self._fetching = True

        def on_scene(done: Future[Scene]) -> None:
            self._fetching = False
            if done.exception() is None:
                self._scene.take(done.result())
                self._mark_changed()
                self._fetch_surfaces()

        self._node.ask_later(keys.SIM, SceneQuery()).add_done_callback(on_scene)

    def _fetch_surfaces(self) -> None:
        if (cache := self._surfaces) is None:
            return
        wanted = list(cache.wanted(self._scene.bodies.values()).items())
        for start in range(0, len(wanted), _SURFACES_AT_ONCE):
            self._fetch_some(cache, dict(wanted[start : start + _SURFACES_AT_ONCE]))

    def _fetch_some(self, cache: SurfaceCache, kinds: dict[str, Kind]) -> None:
        def on_surfaces(done: Future[Surfaces]) -> None:
            if done.exception() is not None:
                cache.reset_requests(kinds.values())
                self._node.later(_RETRY_S, self._fetch_surfaces)
                return
            if not cache.take_reply(kinds, done.result().surfaces):
                self._node.later(_RETRY_S, self._fetch_surfaces)
            self._resend_planning_scene()

        self._node.ask_later(keys.SIM, SurfaceQuery(names=tuple(kinds))).add_done_callback(on_surfaces)

    def _known_surfaces(self) -> Mapping[str, Surface]:
        if (cache := self._surfaces) is None:
            return {}
        known = {name: cache.of(body) for name, body in self._scene.bodies.items()}
        return {name: surface for name, surface in known.items() if surface is not None}

    # Publications

    def _tick(self) -> None:
        if self._map.seq < 0:
            return
        if self._is_stale:
            self._is_stale = False
            self._shapes.fetch(self._map.entities.values())
            bodies = self._scene.bodies
            self._things = located_things(self._map.entities, bodies, self._live, self._shapes.of)
        at = Moment(self._frame, time.time_ns())
        if self._is_due("transforms", self._period_s):
            self._transform(at)
        if _differ(self._things, self._published) and self._is_due("whole", _WHOLE_S):
            self._published = self._things
            self._put(self._topics.detections, messages.detections(self._things.values(), at))
            self._put(self._topics.markers, messages.markers(self._things.values(), at))
            self._plan(at)
            self._floor_differs = True
        if self._floor_differs and not self._asking_floor and self._is_due("floor", _FLOOR_S):
            self._ask_floor()

    def _ask_floor(self) -> None:
        self._floor_differs, self._asking_floor = False, True

        def on_floor(done: Future[Plan]) -> None:
            self._asking_floor = False
            if done.exception() is None:
                at = Moment(self._frame, time.time_ns())
                grid = occupancy(done.result(), _CELL_M, HEIGHTS_M)
                self._put(self._topics.grid, messages.occupancy_grid(grid, at))

        self._node.ask_later(keys.CMD, PlanFloor()).add_done_callback(on_floor)

    def _transform(self, at: Moment) -> None:
        """Publish the transforms of moved objects and published frames, and periodically all of them."""
        again = self._is_due("again", _AGAIN_S)
        before = {} if again else self._transformed
        news = [
            t for t in self._things.values() if t.name not in before or not t.has_same_pose(before[t.name])
        ]
        self._transformed = self._things
        frames = self._frames.now()
        published = {} if again else self._published_frames
        moved = {name: to_matrix for name, to_matrix in frames.items() if published.get(name) != to_matrix}
        self._published_frames = frames
        if news or moved:
            self._put(self._topics.transforms, messages.transforms(news, at, moved))

    def _plan(self, at: Moment) -> None:
        scene = planning_scene(self._things, self._planned, self._known_surfaces(), at)
        self._planned = follow_scene(self._planned, self._things)
        if scene is not None:
            self._put(self._topics.planning_scene, scene)

    def _on_subscriber(self) -> None:
        """Send the whole planning scene to a new subscriber, which may not receive it immediately."""
        for delay_s in _GREETING_S:
            self._node.later(delay_s, self._resend_planning_scene)

    def _resend_planning_scene(self) -> None:
        """Publish the whole planning scene again."""
        self._planned = forget_scene(self._planned, self._things)
        if self._things:
            self._plan(Moment(self._frame, time.time_ns()))

    def _put(self, of: RosTopic, message: Any) -> None:
        self._publishers[of].put(encode(message))

    def _is_due(self, what: str, period_s: float) -> bool:
        now_s = time.monotonic()
        if now_s < self._due_s[what]:
            return False
        self._due_s[what] = now_s + period_s
        return True


def _differ(one: Mapping[str, Thing], other: Mapping[str, Thing] | None) -> bool:
    if one is other:
        return False
    return (
        other is None
        or one.keys() != other.keys()
        or any(
            not thing.has_same_shape(other[name]) or not thing.has_same_pose(other[name])
            for name, thing in one.items()
        )
    )
