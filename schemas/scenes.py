"""The simulated scene: bodies, their poses, and the requests to the simulator."""

from __future__ import annotations

from typing import Annotated, ClassVar, Final, Literal

from msgspec import Meta, Struct, field

from semmap.schemas.calls import MANY, Call
from semmap.schemas.entities import Metres, Name, Pose, Probability, Radians, Size, Vector
from semmap.schemas.joints import Joint

PixelCount = Annotated[int, Meta(ge=1, le=1 << 14)]
"""Width or height of an image [pixel]."""


UPRIGHT: Final = 0.85
"""The cosine of the tilt (32 degrees) beyond which a robot has fallen over."""


class BodyOrder(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A body to create for an entity, at `pose` as of commit `commit`.

    Commit 0 stands for a body of the world's own furniture, without an entity. `model` is a name in the model
    library or of a file; an empty or unknown one means a box of `size_m`. Without `size_m`, the model's size
    is used. `properties` are those that set joint positions (`semmap.schemas.joints.OPENING`); without them,
    the joints are in the model's initial position.
    """

    name: Name
    class_: str = field(name="class")
    model: str = ""
    pose: Pose
    size_m: Size | None = None
    fixed: bool = False
    properties: dict[str, bool | float | str] = {}
    commit: int


class Body(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A body in the scene with its state.

    `commit` is the commit of the pose that was last applied to it. It is 0 if the map never placed the body,
    and -1 for a robot and its parts until they are first placed, moved or driven in this run of the
    simulator. `shape_commit` is the commit of its creation. `entity` is false for the world's own furniture.
    `size_m` is the actual size.

    `joints` are its joints, and `joint_commit` is the commit of the positions that were last applied to them.
    A body is at rest only if its joints are. `part_of` is the parent body, such as the kitchen of an oven in
    an MJCF world. `held_by` is the body that it is attached to, and `grip` its pose in that body's frame.
    `grip_commit` is the commit that last attached or detached it, 0 for a manual change, and -1 if there was
    none.
    """

    name: str
    class_: str | None = field(name="class")
    model: str
    pose: Pose
    size_m: Size
    fixed: bool
    entity: bool
    ghost: bool
    resting: bool
    commit: int
    shape_commit: int
    joints: tuple[Joint, ...] = ()
    joint_commit: int = 0
    part_of: str = ""
    held_by: str = ""
    grip: Pose | None = None
    grip_commit: int = -1
    in_the_way: str = ""
    """For a non-colliding body, the body that occupies its place."""
    body: str = ""
    """Its name in the world file, if that is not a valid name of an entity."""
    label: str = ""
    """The words of its name, if they are not a label of its class: `red mug`."""
    robot: bool = False
    """Whether `semmap up --robot` created it: it becomes a tracked entity for any source of truth."""
    surface: str = ""
    """The digest of its surface, for a body of the world file: equal for bodies of equal surfaces only."""

    @property
    def has_fallen(self) -> bool:
        """Whether it is a robot that has fallen over."""
        return self.robot and not self.part_of and self.pose.upright < UPRIGHT


class Spawned(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The created bodies, and a reason for each one that failed."""

    bodies: tuple[Body, ...]
    failed: dict[str, str]


class Spawn(Call[Spawned], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Create bodies in one step; each one succeeds or fails independently."""

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "spawn"
    bodies: tuple[BodyOrder, ...]


class Deleted(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The names of the deleted bodies."""

    names: tuple[str, ...]


class Delete(Call[Deleted], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Delete bodies; a nonexistent body is not an error."""

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "delete"
    names: tuple[str, ...]


class Placement(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Move one body to `pose`. With a `commit` the map requests it, otherwise it is a manual move."""

    name: str
    pose: Pose
    commit: int | None = None


class BodiesMoved(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The bodies that were moved, and a reason for each one that was not, such as an occupied place."""

    bodies: tuple[Body, ...]
    failed: dict[str, str]
    paused: bool = False
    """Whether simulated time is paused, so that nothing falls or moves."""
    stamp_ns: int = 0
    """The time of the move, by the clock of the poses [ns since 1970]; earlier poses are outdated."""


class MoveBodies(Call[BodiesMoved], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Move bodies kinematically, and then release them to physics."""

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "move"
    placements: tuple[Placement, ...]


class JointOrder(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Move a body's joints: all that open something to `openness`, or named joints to `positions`.

    Positions are in radians and metres; without any, the joints stay. With a `joint`, only that one moves.
    With a `commit` the map requests it, otherwise it is a manual move.
    """

    name: str
    joint: str = ""
    openness: Probability | None = None
    positions: dict[str, float] | None = None
    commit: int | None = None


class JointsMoving(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The bodies whose joints are moving, and a reason for each one that was not moved."""

    bodies: tuple[Body, ...]
    failed: dict[str, str]
    paused: bool = False
    """As for `BodiesMoved`."""
    stamp_ns: int = 0


class MoveJoints(Call[JointsMoving], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Start to move joints with bounded force, so that obstacles stop them."""

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "move-joints"
    orders: tuple[JointOrder, ...]


class GripOrder(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Attach a body to `holder`, or detach it at its current pose if `holder` is "".

    `grip` is its pose in the frame of the holder's bottom centre; without it, the current pose is used.
    With a `commit` the map requests it, otherwise it is a manual change.
    """

    name: str
    holder: str = ""
    grip: Pose | None = None
    commit: int | None = None


class Gripped(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The bodies that were attached or detached, and a reason for each one that failed."""

    bodies: tuple[Body, ...]
    failed: dict[str, str]


class Grip(Call[Gripped], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Attach bodies to other bodies, or detach them."""

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "grip"
    orders: tuple[GripOrder, ...]


Point = tuple[Metres, Metres]
"""A point on the floor, in the map frame [m]."""


class Driven(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The outcome of a drive command and the robot's pose; `driving` if not waited for, or time is paused."""

    name: str
    outcome: Literal["driving", "there", "blocked", "fallen", "stopped"]
    pose: Pose
    paused: bool = False
    """As for `BodiesMoved`."""
    stamp_ns: int = 0


class DriveBase(Call[Driven], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Drive a robot's base through points, in a straight line to each, and turn to `yaw` at the end.

    Without points, it stops. It drives at most at `speed` [m/s] and does not avoid obstacles; a blocked drive
    is aborted. With `wait`, the reply is sent when the drive ends or time is paused.
    """

    VERB: ClassVar[str] = "drive"
    name: str
    to: tuple[Point, ...] = ()
    yaw: Radians | None = None
    speed: float = 0.4
    wait: bool = False


class Leaf(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The part of a surface that one joint moves: `count` rows of its points from row `first` on.

    A hinge rotates them about `axis` through `anchor` [m], a slide shifts them along it, in the body's frame.
    """

    joint: str
    kind: Literal["hinge", "slide"]
    axis: Vector
    anchor: Vector
    first: int
    count: int


class Surface(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The triangle mesh of a body's surface, as raw little-endian arrays in row-major order.

    `points` (N, 3) float32 [m] in the body's frame, whose origin is the bottom centre; outward `normals`
    (N, 3) float32; `colours` (N, 3) uint8, red, green, blue; `triangles` (M, 3) uint32, rows of the points.
    All joints are at 0; `leaves` are the parts that they move.
    """

    points: bytes
    normals: bytes
    colours: bytes
    triangles: bytes
    leaves: tuple[Leaf, ...] = ()


class Surfaces(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The surfaces of existing bodies."""

    surfaces: dict[str, Surface]


class SurfaceQuery(Call[Surfaces], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Request the surfaces of bodies."""

    VERB: ClassVar[str] = "surfaces"
    names: tuple[str, ...]


class WorldQuery(Call[Surface], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Request the surface of the world: walls and other geometry that belongs to no body, in the map frame.

    Planes are left out because they are infinite.
    """

    VERB: ClassVar[str] = "world"


class Picture(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A PNG file."""

    png: bytes


class PictureQuery(Call[Picture], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Render the scene from a camera of the world, or without one, the whole scene.

    With a `box` (lowest and highest corner [m], map frame), that region is rendered from above. `labels`
    shows the names of the bodies whose centres are in the box.
    """

    VERB: ClassVar[str] = "picture"
    camera: str = ""
    box: tuple[Vector, Vector] | None = None
    labels: bool = False
    width: Annotated[int, Meta(ge=16, le=4096)] = 960
    height: Annotated[int, Meta(ge=16, le=4096)] = 640


class CameraPose(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The current pose of a camera's optical frame (x right, y down, z into the scene).

    `part_of` is the body that it is mounted on, or "" for a static camera.
    """

    camera: str
    part_of: str
    pose: Pose


class CamerasQuery(Call[tuple[CameraPose, ...]], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Request the poses of all cameras."""

    VERB: ClassVar[str] = "cameras"


class CameraFrame(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The attachment of each raw plane of a camera.

    `encoding`: `rgb8` has (height, width, 3) bytes; `depth32f` has (height, width) floats, metres along the
    optical axis, 0 for no measurement; `segments16` has (height, width) unsigned numbers, 0 for no body and
    n for `names[n - 1]`. Numbers are little-endian, rows are from the top. `intrinsics` (3, 3) [pixel] and
    `map_from_camera` (4, 4) [m] are in row-major order. The camera's frame is the optical one: x to the
    right, y down, z into the scene. The centre of the first pixel is at (0.5, 0.5).

    Planes of 30 MB or more need a publisher with `CongestionControl.BLOCK`; with Zenoh's default, they are
    dropped.
    """

    camera: str
    encoding: Literal["rgb8", "depth32f", "segments16"]
    width: PixelCount
    height: PixelCount
    stamp_ns: int
    sim_time_s: float
    intrinsics: tuple[float, ...]
    map_from_camera: tuple[float, ...]
    names: tuple[str, ...] = ()


class Scene(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """All bodies. `run` changes with each restart.

    `version` increases with each spawn and delete, and when a body becomes non-colliding or colliding.
    """

    run: str
    version: int
    stamp_ns: int
    sim_time_s: float
    world: str
    bodies: tuple[Body, ...]
    left_out: tuple[str, ...] = ()
    """Bodies of the world that are only parts of the others: names, or descriptions of unnamed ones."""
    unstable: tuple[str, ...] = ()
    """Bodies whose simulated state was no longer finite, so that they were stopped."""


class SceneQuery(Call[Scene], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Request the state of all bodies."""

    VERB: ClassVar[str] = "snapshot"


class Poses(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The current poses of all bodies; `poses` has seven numbers per body: position [m], quaternion wxyz.

    `joints` has the joint positions of all bodies in order [rad, m].
    """

    run: str
    version: int
    stamp_ns: int
    sim_time_s: float
    names: tuple[str, ...]
    poses: tuple[float, ...]
    resting: tuple[bool, ...]
    commits: tuple[int, ...]
    joints: tuple[float, ...] = ()
    joint_commits: tuple[int, ...] = ()
    """One commit for each body with joints."""
    drives: dict[str, tuple[Point, ...]] = {}
    """The points that driving robots still have to reach, by robot; the last one is the goal."""
