"""Entities of the map: poses, sizes, names, references and provenance.

What a map has very many of is not looked through for garbage (`gc=False`): it is frozen, so there is no cycle
of such alone, and a collection that passes a hundred thousand of them takes longer than reading them.
"""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Container
from typing import Annotated, Literal

from msgspec import Meta, Struct, field

from semmap.schemas.joints import Joint

_MARKS = (
    "\u0300-\u036f\u0483-\u0487\u0591-\u05bd\u05bf\u05c1\u05c2\u05c4\u05c5\u05c7\u0610-\u061a\u064b-\u065f\u0670"
    "\u06d6-\u06dc\u06df-\u06e4\u06e7\u06e8\u06ea-\u06ed\u0711\u0730-\u074a\u07a6-\u07b0\u0900-\u0963\u0971-\u0e3a"
    "\u0e40-\u0e4e\u0e81-\u0ece\u0f18\u0f19\u0f35\u0f37\u0f39\u0f3e-\u0f84\u0f86-\u0fbc\u1000-\u1049\u1050-\u109d"
    "\u1780-\u17d3\u17dd\u3099\u309a"
)
"""Vowel signs and the like, without which words of many scripts cannot be written; `\\w` lacks them."""

NAME_PATTERN = rf"^[^\W\d][\w.\-{_MARKS}]{{0,127}}$(?!\n)"
"""A name is the local part of an IRI, a chunk of a key and the name of a body: letters of any script, digits,
`_`, `.` and `-`, beginning with a letter or `_`. (Alone, `$` would let a line end pass.)"""

REACH_M = 10_000.0
"""Coordinates beyond this are taken for a mistake."""

CommandId = Annotated[str, Meta(min_length=1, max_length=200)]
Name = Annotated[str, Meta(pattern=NAME_PATTERN)]
Metres = Annotated[float, Meta(ge=-REACH_M, le=REACH_M)]
Length = Annotated[float, Meta(gt=0.0, le=REACH_M)]
Unit = Annotated[float, Meta(ge=-1.001, le=1.001)]
Angle = Annotated[float, Meta(ge=-1e6, le=1e6)]
Text = Annotated[str, Meta(min_length=1, max_length=1000)]
Word = Annotated[str, Meta(max_length=1000)]
"""What is looked up: a name, a class or a reference, as somebody wrote it."""
Remark = Annotated[str, Meta(max_length=1000)]
Probability = Annotated[float, Meta(ge=0.0, le=1.0)]

Vector = tuple[Metres, Metres, Metres]
Size = tuple[Length, Length, Length]
"""Extent along the body's own x, y and z [m]."""
Quaternion = tuple[Unit, Unit, Unit, Unit]
"""Unit quaternion, `wxyz`."""

Source = Literal["operator", "file", "scene", "perception", "agent"]
"""Who says so. Only operators and files decide what a thing is; anybody may say where it is now."""

LESSER: frozenset[Source] = frozenset(("scene", "perception", "agent"))
"""Those that never outrank an operator. An `agent` decides by itself: a language model, for one."""

IDENTITY: Quaternion = (1.0, 0.0, 0.0, 0.0)
_UNIT_TOLERANCE = 1e-3


def require_unit(quaternion: Quaternion) -> None:
    """Raises ValueError for a quaternion that is not of unit length (to one in a thousand)."""
    if quaternion == IDENTITY:  # as most are
        return
    norm = math.hypot(*quaternion)
    if not abs(norm - 1.0) <= _UNIT_TOLERANCE:  # NaN is no length
        raise ValueError(f"the quaternion {quaternion} has length {norm:.4g}; it must be 1")


class Pose(Struct, frozen=True, gc=False, kw_only=True, forbid_unknown_fields=True):
    """Where a thing stands in the map frame (z up): its bottom centre [m] and its orientation.

    Raises ValueError for a quaternion that is not of unit length (to one in a thousand).
    """

    position_m: Vector
    orientation_wxyz: Quaternion = IDENTITY

    def __post_init__(self) -> None:
        if self.orientation_wxyz != IDENTITY:  # as that of most is not: a map has very many
            require_unit(self.orientation_wxyz)

    @property
    def yaw_rad(self) -> float:
        """Rotation about the map's z axis, in (-pi, pi]."""
        w, x, y, z = self.orientation_wxyz
        return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))

    @property
    def upright(self) -> float:
        """The cosine of the angle between its own z axis and the map's: 1 upright, 0 on its side."""
        _, x, y, _ = self.orientation_wxyz
        return 1.0 - 2.0 * (x * x + y * y)


def name_stem(class_name: str) -> str:
    """What the names of a class's entities begin with: the class in lower case, without a prefix."""
    stem = re.sub(r"[^\w.-]", "", composed(class_name.rpartition(":")[2].lower()))[:120]
    return stem if stem[:1].isalpha() else f"_{stem}"


def free_name(class_name: str, taken: Container[str]) -> str:
    """The class in lower case, without a prefix, and the first number that is free: `chair1`."""
    stem, number = name_stem(class_name), 1
    while f"{stem}{number}" in taken:
        number += 1
    return f"{stem}{number}"


def composed(name: str) -> str:
    """A name in Unicode's composed form (NFC), in which names are kept and compared."""
    return name if name.isascii() else unicodedata.normalize("NFC", name)


def orientation_from_yaw(yaw_rad: float) -> Quaternion:
    """The quaternion that turns by `yaw_rad` about z."""
    return (math.cos(yaw_rad / 2.0), 0.0, 0.0, math.sin(yaw_rad / 2.0))


def rounded(pose: Pose) -> Pose:
    """To a micrometre, and without minus zeros: what physics knows no better is not worth its digits."""
    x, y, z = (round(value, 6) + 0.0 for value in pose.position_m)
    qw, qx, qy, qz = (round(value, 6) + 0.0 for value in pose.orientation_wxyz)
    return Pose(position_m=(x, y, z), orientation_wxyz=(qw, qx, qy, qz))


def carried(pose: Pose, was: Pose, now: Pose) -> Pose:
    """Where a thing at `pose` comes to be when its bearer goes from `was` to `now`, as one rigid body."""
    turn = _product(now.orientation_wxyz, _inverse(was.orientation_wxyz))
    px, py, pz = (p - o for p, o in zip(pose.position_m, was.position_m, strict=True))
    _, *offset = _product(_product(turn, (0.0, px, py, pz)), _inverse(turn))
    x, y, z = (o + d for o, d in zip(now.position_m, offset, strict=True))
    if was.orientation_wxyz == now.orientation_wxyz:
        return rounded(Pose(position_m=(x, y, z), orientation_wxyz=pose.orientation_wxyz))
    turned = _product(turn, pose.orientation_wxyz)
    length = math.hypot(*turned)
    qw, qx, qy, qz = (value / length for value in turned)
    return rounded(Pose(position_m=(x, y, z), orientation_wxyz=(qw, qx, qy, qz)))


def compose(frame: Pose, pose: Pose) -> Pose:
    """Where a thing that is at `pose` in a frame is in that in which the frame itself is at `frame`.

    `map_from_lidar = compose(map_from_robot, robot_from_lidar)`.
    """
    turn = frame.orientation_wxyz
    _, *offset = _product(_product(turn, (0.0, *pose.position_m)), _inverse(turn))
    x, y, z = (o + d for o, d in zip(frame.position_m, offset, strict=True))
    turned = _product(turn, pose.orientation_wxyz)
    length = math.hypot(*turned)
    qw, qx, qy, qz = (value / length for value in turned)
    return Pose(position_m=(x, y, z), orientation_wxyz=(qw, qx, qy, qz))


def inverse(frame: Pose) -> Pose:
    """Where the outer frame is in the one that is at `frame` in it."""
    back = _inverse(frame.orientation_wxyz)
    x, y, z = frame.position_m
    origin = Pose(position_m=(-x, -y, -z))
    return compose(Pose(position_m=(0.0, 0.0, 0.0), orientation_wxyz=_unit(back)), origin)


def relative(pose: Pose, frame: Pose) -> Pose:
    """A pose as seen from a frame; both are given in one and the same."""
    return compose(inverse(frame), pose)


def _unit(q: Quaternion) -> Quaternion:
    length = math.hypot(*q)
    w, x, y, z = q
    return w / length, x / length, y / length, z / length


def _product(a: Quaternion, b: Quaternion) -> Quaternion:
    """The rotation `b`, then `a`."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


def _inverse(q: Quaternion) -> Quaternion:
    """The rotation back; `q` may be off unit length by what `require_unit` allows."""
    w, x, y, z = q
    square = w * w + x * x + y * y + z * z
    return (w / square, -x / square, -y / square, -z / square)


def distance_m(a: Pose, b: Pose) -> float:
    """Distance of two positions [m]."""
    return math.dist(a.position_m, b.position_m)


def angle_rad(a: Pose, b: Pose) -> float:
    """The angle of the rotation from one orientation to the other, in [0, pi]."""
    dot = abs(sum(p * q for p, q in zip(a.orientation_wxyz, b.orientation_wxyz, strict=True)))
    return 2.0 * math.acos(min(1.0, dot))


class Provenance(Struct, frozen=True, gc=False, kw_only=True, forbid_unknown_fields=True):
    """The commit that last changed something, and who made it."""

    commit: int
    stamp_ns: int
    source: Source
    agent: str = ""
    reason: str = ""
    confidence: Probability | None = None


Value = bool | int | float | str
"""A property's value: a boolean, a number, a text (with @ and its language), or an individual's name."""
Stated = Value | tuple[Value, ...]
"""What is stated by a property: one value if it is functional, else all of them."""


class BodyState(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What the simulator makes of an entity.

    `present`: it stands there. `ghost`: seen but not colliding, because something else fills the place.
    `pending`: not spawned yet. `failed`: cannot be made, `detail` says why. `missing`: the scene, which is
    the truth here, does not have it. `none`: it is not to have one (a place; or only perception tells the
    map). `unknown`: no simulator runs.
    """

    status: Literal["present", "ghost", "pending", "failed", "missing", "none", "unknown"]
    detail: str = ""
    model: str = ""
    """The model that the body was made from; for a pending one, the model that it will have."""
    own_size: bool = False
    """The entity's size is that of its model, because the map states none."""
    joints: tuple[Joint, ...] = ()
    """The joints that move parts of the body, as they stand just now."""
    openness: float | None = None
    """How far open it is just now, 0 to 1: as the joint that is open furthest; None if nothing opens."""
    switched_on: bool | None = None
    """Whether any of its switches is on just now; None if it has none."""


Tracking = Literal["sim", "stream"]
"""Where the live poses of a tracked entity come from: the simulator, or whoever publishes them."""


Tracked = Literal["", "sim", "stream"]
"""The same, or "" for what is not tracked."""


class Live(Struct, frozen=True, gc=False, kw_only=True, forbid_unknown_fields=True):
    """Where a tracked entity is just now, as far as was heard: `age_s` seconds ago, measured at `stamp_ns`.

    `stale`: nothing has been heard for longer than `semmap up --stale`; it is taken to be where it was.
    """

    pose: Pose
    stamp_ns: int
    age_s: float
    source: Tracking
    stale: bool = False


class Entity(Struct, frozen=True, gc=False, kw_only=True, forbid_unknown_fields=True):
    """One individual of the map that is somewhere: an object, a person, a wall, or a place.

    Class names are local names of the TBox (`Chair`); `types` holds all that are asserted or follow.
    `size_m` is its extent along its own axes [m]. In commits and in what is published it is what the map
    states, or None; replies fill in what its body measures, or what its model does. Where there is no model
    either, it is None: the size is not known, and a box stands in for it in the scene.
    `tracked` says where its live poses come from, or "" for what is not tracked; `pose` is then the last one
    that was journalled, and `live`, which replies fill in, the newest.
    `pose_provenance` says what last changed its pose, `shape_provenance` its class or size,
    `reference_provenance` what it is called, `joint_provenance` how far open it is and how its joints stand
    (None if that was never stated), `switch_provenance` whether it is on and how its switches stand, and
    `grip_provenance` what holds it (likewise). `properties` are the data and object properties that are
    asserted of it.
    """

    name: str
    class_: str = field(name="class")
    iri: str
    types: tuple[str, ...]
    pose: Pose | None = None
    size_m: Size | None = None
    preferred_reference: str | None = None
    alternative_references: tuple[str, ...] = ()
    conflict: str = ""
    """What perception sees against this, kept beside it because an operator said it; empty for nothing."""
    properties: dict[str, Stated] = {}
    """Other asserted properties, by name: `{"isOpen": true, "hasColor": ["color_red"]}`."""
    place: bool = False
    fixed: bool = False
    model: str = ""
    body: BodyState | None = None
    tracked: Tracked = ""
    live: Live | None = None
    provenance: Provenance
    pose_provenance: Provenance
    shape_provenance: Provenance
    reference_provenance: Provenance
    joint_provenance: Provenance | None = None
    switch_provenance: Provenance | None = None
    grip_provenance: Provenance | None = None

    @property
    def joints_said(self) -> Provenance | None:
        """What last changed how its joints are to stand, those of switches among them; None for nothing."""
        said = (self.joint_provenance, self.switch_provenance)
        return max((p for p in said if p is not None), key=lambda p: p.commit, default=None)


class ClassInfo(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One named class of the TBox, as commands need it.

    `name` is the local name of its IRI, or `prefixed` where other classes share that.
    """

    name: str
    iri: str
    prefixed: str = ""
    """The name with its prefix: `dm:Chair`. It always means this class."""
    parents: tuple[str, ...]
    ancestors: tuple[str, ...]
    labels: dict[str, str]
    """Language tag (or "") to text, one a language."""
    also: tuple[str, ...] = ()
    """Its other labels."""
    comment: str = ""
    spatial: bool
    """Its individuals are in space: they may be added."""
    place: bool
    fixed: bool
    model: str
    asserted: int = 0
    """How many entities say they are of this class."""
    inferred: int = 0
    """How many are, by inference."""


class PropertyInfo(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One data or object property of the TBox that may be stated of an entity, as commands need it."""

    name: str
    iri: str
    kind: Literal["data", "object"]
    functional: bool
    """It has one value at most: a new one takes the place of the one before."""
    domain: tuple[str, ...]
    range: tuple[str, ...]
    """Datatypes or classes; empty for anything."""
    labels: dict[str, str]
    """Language tag (or "") to text."""
    comment: str = ""
    values: dict[str, str]
    """The individuals of the TBox that it may point to, by name, with their labels."""
