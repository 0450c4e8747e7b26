"""The simulated scene: bodies, their poses, and what one may ask of the simulator."""

from __future__ import annotations

from typing import Annotated, ClassVar, Final, Literal

from msgspec import Meta, Struct, field

from semmap.schemas.calls import MANY, Call
from semmap.schemas.entities import Angle, Metres, Name, Pose, Probability, Size, Vector
from semmap.schemas.joints import Joint

PixelCount = Annotated[int, Meta(ge=1, le=1 << 14)]
"""How wide or high a picture may be."""


UPRIGHT: Final = 0.85
"""A robot stands as long as its own z axis is so much of an upright one; at 32 degrees it falls over."""


class BodyOrder(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A body to be made for an entity, standing at `pose` as of commit `commit`.

    With commit 0 it is for no entity, but of the world's own furniture.
    `model` is a name of the model library or of a file; empty or unknown means a box of `size_m`.
    `size_m` None means the model's own size. `properties` are those by which the map states how its joints
    stand (`semmap.schemas.joints.OPENING`); without them they stand as the model has them.
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
    """A body as it stands in the scene.

    `commit` is the commit whose pose it was last ordered to take, 0 for what the map never placed, and -1
    for a robot and its parts until it is first placed, moved or driven in this run of the simulator.
    `shape_commit` is the commit it was made for. `entity` tells bodies made from the map from the
    world's own furniture. `size_m` is what it really measures. `joints` are those that move parts of it, and
    `joint_commit` is the commit whose positions these were last ordered to take. It rests when these do, too.
    `part_of` names the body that carries it, as a kitchen does its oven in an MJCF world. `held_by` names the
    body that holds it and `grip` is where, in that body's frame; `grip_commit` is the commit that last
    ordered it to be held or let go, 0 for a hand, and -1 while nobody has done either.
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
    """The body that fills the place of a ghost, where it is one of the scene."""
    robot: bool = False
    """It was put there by `semmap up --robot`: it becomes an entity whatever the truth is, and is tracked."""

    @property
    def has_fallen(self) -> bool:
        """Whether it is a robot that lies on its side."""
        return self.robot and not self.part_of and self.pose.upright < UPRIGHT


class Spawned(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What came of it: the bodies made, and a reason for each that could not be."""

    bodies: tuple[Body, ...]
    failed: dict[str, str]


class Spawn(Call[Spawned], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Make bodies, all in one go; each succeeds or fails by itself."""

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "spawn"
    bodies: tuple[BodyOrder, ...]


class Deleted(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The bodies that were there and are gone."""

    names: tuple[str, ...]


class Delete(Call[Deleted], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Take bodies away; one that is not there is no error."""

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "delete"
    names: tuple[str, ...]


class Placement(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Put one body at `pose`. With a `commit` it is the map's order, without one it is a hand."""

    name: str
    pose: Pose
    commit: int | None = None


class BodiesMoved(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The bodies that were moved, where there was room for them, and a reason for each that was not."""

    bodies: tuple[Body, ...]
    failed: dict[str, str]
    paused: bool = False
    """Simulated time stands still: nothing falls or moves before it runs again."""
    stamp_ns: int = 0
    """When it was done, by the clock of the poses [ns since 1970]: earlier ones are from before."""


class MoveBodies(Call[BodiesMoved], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Put bodies elsewhere: kinematically, then released to physics."""

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "move"
    placements: tuple[Placement, ...]


class JointOrder(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Move a body's joints: all that open something to `openness`, or each that is named to its position.

    Positions are in radians and metres; none at all leave everything as it stands. With a `joint` it is about
    that one only. With a `commit` it is the map's order, without one it is a hand.
    """

    name: str
    joint: str = ""
    openness: Probability | None = None
    positions: dict[str, float] | None = None
    commit: int | None = None


class JointsMoving(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The bodies whose joints are on their way, and a reason for each that was not moved."""

    bodies: tuple[Body, ...]
    failed: dict[str, str]
    paused: bool = False
    """As for `BodiesMoved`."""
    stamp_ns: int = 0


class MoveJoints(Call[JointsMoving], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Begin to move joints, as a hand would: with bounded force, so that what is in the way stops them."""

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "move-joints"
    orders: tuple[JointOrder, ...]


class GripOrder(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Have a body held by another (`holder`), or by nobody (""): then it is let go where it is.

    `grip` is where it is to be in the frame of its holder's bottom centre; without one it is held as it is.
    With a `commit` it is the map's order, without one it is a hand.
    """

    name: str
    holder: str = ""
    grip: Pose | None = None
    commit: int | None = None


class Gripped(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The bodies that are held or were let go, and a reason for each for which that cannot be."""

    bodies: tuple[Body, ...]
    failed: dict[str, str]


class Grip(Call[Gripped], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Weld bodies to those that hold them, or let them go."""

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "grip"
    orders: tuple[GripOrder, ...]


Point = tuple[Metres, Metres]
"""On the floor, in the map frame [m]."""


class Driven(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How a course ended, and where the robot is then; `driving` if nobody waited, or time is paused."""

    name: str
    outcome: Literal["driving", "there", "blocked", "fallen", "stopped"]
    pose: Pose
    paused: bool = False
    """As for `BodiesMoved`."""
    stamp_ns: int = 0


class DriveBase(Call[Driven], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Drive a robot's base through these points, in a straight line to each, and at the end turn to `yaw`.

    No points stop it. It goes at most at `speed` [m/s]; nobody looks whether the way is free, and a course
    along which it gets no further is given up. With `wait` the reply comes when the course ends, or time
    is paused.
    """

    VERB: ClassVar[str] = "drive"
    name: str
    to: tuple[Point, ...] = ()
    yaw: Angle | None = None
    speed: float = 0.4
    wait: bool = False


class Leaf(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What one joint moves of a surface: `count` rows of its points from row `first` on.

    A hinge turns them about `axis` through `anchor` [m], a slide shifts them along it, in the body's frame.
    """

    joint: str
    kind: Literal["hinge", "slide"]
    axis: Vector
    anchor: Vector
    first: int
    count: int


class Surface(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A body's surface in triangles, for those who draw it: arrays as raw little-endian bytes, row by row.

    `points` (N, 3) float32 [m] in the body's frame, whose origin is the bottom centre; outward `normals`
    (N, 3) float32; `colours` (N, 3) uint8, red, green, blue; `triangles` (M, 3) uint32, rows of the points.
    It is with all joints at 0; `leaves` are what these move.
    """

    points: bytes
    normals: bytes
    colours: bytes
    triangles: bytes
    leaves: tuple[Leaf, ...] = ()


class Surfaces(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Those of the bodies that are there; of the world's own as their parts stood when it was asked."""

    surfaces: dict[str, Surface]


class SurfaceQuery(Call[Surfaces], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What these bodies look like."""

    VERB: ClassVar[str] = "surfaces"
    names: tuple[str, ...]


class WorldQuery(Call[Surface], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What the world itself looks like: the walls and whatever else of its file is no body, in the map frame.

    Planes are left out, for they have no end.
    """

    VERB: ClassVar[str] = "world"


class Picture(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A PNG file."""

    png: bytes


class PictureQuery(Call[Picture], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A picture of the scene for people, from a camera of the world; or, without one, of everything.

    With a `box` (lowest and highest corner [m], map frame) it is of that, seen from above. `labels` writes
    the names of the entities' bodies on it, of those whose middle is in the box.
    """

    VERB: ClassVar[str] = "picture"
    camera: str = ""
    box: tuple[Vector, Vector] | None = None
    labels: bool = False
    width: Annotated[int, Meta(ge=16, le=4096)] = 960
    height: Annotated[int, Meta(ge=16, le=4096)] = 640


class CameraPose(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Where a camera of the world is just now: its optical frame (x right, y down, z into the scene).

    `part_of` names the body that carries it; "" for one that stays where it is.
    """

    camera: str
    part_of: str
    pose: Pose


class CamerasQuery(Call[tuple[CameraPose, ...]], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Where all cameras are."""

    VERB: ClassVar[str] = "cameras"


class CameraFrame(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What goes with each raw plane of a camera, as its attachment.

    `encoding`: `rgb8` has (height, width, 3) bytes; `depth32f` (height, width) floats, metres along the
    optical axis, 0 where nothing is seen; `segments16` (height, width) unsigned numbers, 0 for none of
    the bodies and n for `names[n - 1]`. Numbers are little-endian, rows from the top. `intrinsics` (3, 3)
    [pixel] and `map_from_camera` (4, 4) [m] are row by row; the camera's frame is the optical one, with x
    to the right, y down, z into the scene, and the middle of the first pixel at (0.5, 0.5).

    A publisher that drops what cannot go at once, as Zenoh's do unless told otherwise, drops every plane of
    some 30 MB: such want `CongestionControl.BLOCK`.
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
    """Every body. `run` differs after a restart.

    `version` grows with each spawn and delete, and when a body becomes a ghost or ceases to be one.
    """

    run: str
    version: int
    stamp_ns: int
    sim_time_s: float
    world: str
    bodies: tuple[Body, ...]
    left_out: tuple[str, ...] = ()
    """The bodies of the world that are none of these, but only parts of them: names, or what is told of those
    without a name."""


class SceneQuery(Call[Scene], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Every body as it stands."""

    VERB: ClassVar[str] = "snapshot"


class Poses(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Where all bodies are now; `poses` has seven numbers a body: position [m], quaternion wxyz.

    `joints` has the positions of the joints of all bodies that have any, in their order [rad, m].
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
    """One for each body that has joints."""
