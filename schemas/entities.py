"""Entities of the map: poses, sizes, names, labels and provenance.

Structs that a map has very many of are excluded from garbage collection (`gc=False`). They are frozen, so
they cannot form cycles, and scanning a hundred thousand of them takes longer than reading them.
"""

from __future__ import annotations

import hashlib
import math
import re
import unicodedata
from collections.abc import Container
from typing import TYPE_CHECKING, Annotated, Final, Literal, TypeAlias

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
"""A name is the local part of an IRI, a chunk of a key and the name of a body. It has letters of any script,
digits, `_`, `.` and `-`, and begins with a letter or `_`. (`$` alone would accept a line feed at the end.)"""

_NOT_OF_NAMES = re.compile(rf"[^\w.\-{_MARKS}]")
_LONGEST_NAME: Final = 128

REACH_M = 10_000.0
"""Larger coordinates are rejected."""

CommandId = Annotated[str, Meta(min_length=1, max_length=200)]
Name = Annotated[str, Meta(pattern=NAME_PATTERN)]
Metres = Annotated[float, Meta(ge=-REACH_M, le=REACH_M)]
Length = Annotated[float, Meta(gt=0.0, le=REACH_M)]
Unit = Annotated[float, Meta(ge=-1.001, le=1.001)]
Radians = Annotated[float, Meta(ge=-1e6, le=1e6)]
if TYPE_CHECKING:
    Angle: TypeAlias = float
else:
    Angle = float | Annotated[str, Meta(max_length=40)]
"""An angle as entered by a user: radians, or a text such as `90deg`; messages convert it to radians."""
Text = Annotated[str, Meta(min_length=1, max_length=1000)]
Word = Annotated[str, Meta(max_length=1000)]
"""A name, class or label to look up, as entered by a user."""
Remark = Annotated[str, Meta(max_length=1000)]
Probability = Annotated[float, Meta(ge=0.0, le=1.0)]

Vector = tuple[Metres, Metres, Metres]
Size = tuple[Length, Length, Length]
"""Extent along the body's own x, y and z [m]."""
Quaternion = tuple[Unit, Unit, Unit, Unit]
"""Unit quaternion, `wxyz`."""

Source = Literal["operator", "file", "scene", "perception", "agent"]
"""The source of a change. Only operators and files decide classes; any source may change a pose."""

LESSER: frozenset[Source] = frozenset(("scene", "perception", "agent"))
"""Sources that never override an operator. An `agent` acts autonomously, such as a language model."""

IDENTITY: Quaternion = (1.0, 0.0, 0.0, 0.0)
_UNIT_TOLERANCE = 1e-3


def require_unit(quaternion: Quaternion) -> None:
    """Raise ValueError for a quaternion that is not of unit length (tolerance 0.001)."""
    if quaternion == IDENTITY:  # the usual case
        return
    norm = math.hypot(*quaternion)
    if not abs(norm - 1.0) <= _UNIT_TOLERANCE:  # also true for NaN
        raise ValueError(f"the quaternion {quaternion} has length {norm:.4g}; it must be 1")


class Pose(Struct, frozen=True, gc=False, kw_only=True, forbid_unknown_fields=True):
    """A pose in the map frame (z up): the bottom centre [m] and the orientation of an object.

    Raises ValueError for a quaternion that is not of unit length (tolerance 0.001).
    """

    position_m: Vector
    orientation_wxyz: Quaternion = IDENTITY

    def __post_init__(self) -> None:
        if self.orientation_wxyz != IDENTITY:  # skips the call for most poses
            require_unit(self.orientation_wxyz)

    @property
    def yaw_rad(self) -> float:
        """Rotation about the map's z axis, in (-pi, pi]."""
        w, x, y, z = self.orientation_wxyz
        return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))

    @property
    def roll_pitch_rad(self) -> tuple[float, float]:
        """The rotations about its x axis and then about the y axis, before that by `yaw_rad`."""
        w, x, y, z = self.orientation_wxyz
        roll = math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
        return roll, math.asin(max(-1.0, min(1.0, 2.0 * (w * y - x * z))))

    @property
    def upright(self) -> float:
        """The cosine of the angle between its z axis and the map's: 1 is upright, 0 is on its side."""
        _, x, y, _ = self.orientation_wxyz
        return 1.0 - 2.0 * (x * x + y * y)


def name_stem(class_name: str) -> str:
    """Return the first part of generated names: the class in lower case, without a prefix."""
    stem = re.sub(r"[^\w.-]", "", composed(class_name.rpartition(":")[2].lower()))[:120]
    return stem if stem[:1].isalpha() else f"_{stem}"


def free_name(class_name: str, taken: Container[str]) -> str:
    """Return the class in lower case, without a prefix, with the first unused number: `chair1`."""
    stem, number = name_stem(class_name), 1
    while f"{stem}{number}" in taken:
        number += 1
    return f"{stem}{number}"


def bounds(pose: Pose, size_m: Vector) -> tuple[Vector, Vector]:
    """Return the lowest and highest corner [m, map frame] of a box around a box with this pose and size."""
    w, x, y, z = pose.orientation_wxyz
    rows = (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )
    half = tuple(length / 2.0 for length in size_m)
    middle = [at + row[2] * half[2] for at, row in zip(pose.position_m, rows, strict=True)]
    reach = [sum(abs(of) * length for of, length in zip(row, half, strict=True)) for row in rows]
    low, high = ([m + sign * r for m, r in zip(middle, reach, strict=True)] for sign in (-1.0, 1.0))
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def valid_name(text: str, taken: Container[str] = ()) -> str:
    """Return a name for an object that is called `text` elsewhere, such as `Apple_01.2` for `Apple|+01.2`.

    A valid text is its own name. Otherwise, each sequence of other characters becomes `_`, and a name that is
    in `taken` gets the first unused number.
    """
    name = re.sub(rf"[^\w.\-{_MARKS}]+", "_", composed(text)).strip("_")[:120] if not is_name(text) else text
    stem = name if is_name(name) else f"_{name}"
    name, number = stem, 1
    while name in taken:
        number += 1
        name = f"{stem}_{number}"
    return name


def is_name(text: str) -> bool:
    """Return whether a text can be the name of an entity."""
    return re.match(NAME_PATTERN, text) is not None


def names_in(text: str) -> list[str]:
    """Return the words of a text that can be names of entities: `:cup1` and `cup1's` contain `cup1`."""
    return [word for word in _NOT_OF_NAMES.split(text) if is_name(word)]


def composed(name: str) -> str:
    """Return a name in Unicode's composed form (NFC), in which names are stored and compared."""
    return name if name.isascii() else unicodedata.normalize("NFC", name)


def name_of_text(text: str) -> str:
    """Return the valid name that stands for any text. A valid name stands for itself.

    A character that names cannot have becomes its code in hexadecimal between `_x` and `_`: `a$` is `a_x24_`.
    If the first character is only valid further on, such as a digit, `_` precedes it. The end of a name that
    is too long is replaced by a digest.
    """
    name = composed(text)
    if is_name(name):
        return name
    name = _NOT_OF_NAMES.sub(lambda found: f"_x{ord(found[0]):X}_", name)
    if not is_name(name[:1]):
        name = f"_{name}"
    if len(name) > _LONGEST_NAME:
        digest = hashlib.blake2b(text.encode(), digest_size=8).hexdigest()
        name = f"{name[: _LONGEST_NAME - 1 - len(digest)]}_{digest}"
    return name


_ANGLE: Final = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(deg|°|rad)?\s*")


def parse_angle(value: float | str) -> float:
    """Return an angle [rad]: a number in radians, or a text such as `1.57`, `1.57rad`, `90deg` or `90°`.

    An angle with a unit is reduced to one turn. Raises ValueError for other texts, and for a number beyond
    one turn, because that is most likely in degrees.
    """
    unit = None
    if isinstance(value, str):
        if (match := _ANGLE.fullmatch(value)) is None:
            raise ValueError(f"'{value}' is not an angle; use radians (1.57) or degrees (90deg)")
        number, unit = float(match[1]), match[2]
    else:
        number = value
    angle = math.radians(number) if unit in ("deg", "°") else number
    if abs(angle) <= _TURN_RAD:
        return angle
    if not math.isfinite(angle):
        raise ValueError(f"'{value}' is not an angle; use radians (1.57) or degrees (90deg)")
    if unit is None:
        raise ValueError(f"the angle {number:g} exceeds one turn in radians; for degrees write {number:g}deg")
    return math.remainder(angle, math.tau)


_TURN_RAD: Final = math.tau + 1e-6


def orientation_from_yaw(yaw_rad: float) -> Quaternion:
    """Return the quaternion of a rotation by `yaw_rad` about z."""
    return (math.cos(yaw_rad / 2.0), 0.0, 0.0, math.sin(yaw_rad / 2.0))


def rounded(pose: Pose) -> Pose:
    """Return a pose rounded to a micrometre, without negative zeros."""
    x, y, z = (round(value, 6) + 0.0 for value in pose.position_m)
    qw, qx, qy, qz = (round(value, 6) + 0.0 for value in pose.orientation_wxyz)
    return Pose(position_m=(x, y, z), orientation_wxyz=(qw, qx, qy, qz))


def carried(pose: Pose, was: Pose, now: Pose) -> Pose:
    """Return the new pose of an object that moves rigidly with a support from `was` to `now`."""
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
    """Return `pose`, given relative to a frame, in the parent frame in which the frame's pose is `frame`.

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
    """Return the pose of the parent frame relative to the frame."""
    back = _inverse(frame.orientation_wxyz)
    x, y, z = frame.position_m
    origin = Pose(position_m=(-x, -y, -z))
    return compose(Pose(position_m=(0.0, 0.0, 0.0), orientation_wxyz=_unit(back)), origin)


def relative(pose: Pose, frame: Pose) -> Pose:
    """Return a pose relative to a frame; both are given in the same parent frame."""
    return compose(inverse(frame), pose)


def _unit(q: Quaternion) -> Quaternion:
    length = math.hypot(*q)
    w, x, y, z = q
    return w / length, x / length, y / length, z / length


def _product(a: Quaternion, b: Quaternion) -> Quaternion:
    """Return the rotation `b` followed by `a`."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


def _inverse(q: Quaternion) -> Quaternion:
    """Return the inverse rotation; `q` may deviate from unit length as far as `require_unit` allows."""
    w, x, y, z = q
    square = w * w + x * x + y * y + z * z
    return (w / square, -x / square, -y / square, -z / square)


def distance_m(a: Pose, b: Pose) -> float:
    """Return the distance of two positions [m]."""
    return math.dist(a.position_m, b.position_m)


def angle_rad(a: Pose, b: Pose) -> float:
    """Return the angle of the rotation from one orientation to the other, in [0, pi]."""
    dot = abs(sum(p * q for p, q in zip(a.orientation_wxyz, b.orientation_wxyz, strict=True)))
    return 2.0 * math.acos(min(1.0, dot))


class Provenance(Struct, frozen=True, gc=False, kw_only=True, forbid_unknown_fields=True):
    """The commit that last changed a fact, and its author."""

    commit: int
    stamp_ns: int
    source: Source
    agent: str = ""
    reason: str = ""
    confidence: Probability | None = None


SAME_AS: Final = "sameAs"
"""The property that has the other names of an entity."""

Value = bool | int | float | str
"""A property's value: a boolean, a number, a text (with @ and its language), or an individual's name."""
Stated = Value | tuple[Value, ...]
"""The asserted value of a functional property, or all values of another property."""


class BodyState(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The state of an entity's body in the simulator.

    `present`: it is in the scene. `ghost`: it is visible but does not collide, because another body occupies
    its place. `pending`: it is not spawned yet. `failed`: it cannot be created, for the reason in `detail`.
    `missing`: the scene, which is the source of truth, does not have it. `none`: the entity has no body (a
    place, without a position, or perception is the source of truth). `unknown`: no simulator is running.
    """

    status: Literal["present", "ghost", "pending", "failed", "missing", "none", "unknown"]
    detail: str = ""
    model: str = ""
    """The model of the body; for a pending one, the model that it will have."""
    body: str = ""
    """The name of the body in the world file, if it is another one than the entity's."""
    own_size: bool = False
    """Whether the entity's size is that of its model, because the map has none."""
    joints: tuple[Joint, ...] = ()
    """The joints of the body with their current positions."""
    openness: float | None = None
    """The current openness of the joint that is open furthest, 0 to 1; None if no joint opens something."""
    switched_on: bool | None = None
    """Whether any of its switches is currently on; None if it has none."""


Tracking = Literal["sim", "stream"]
"""The source of a tracked entity's live poses: the simulator or a publisher."""


Tracked = Literal["", "sim", "stream"]
"""The same, or "" for an entity that is not tracked."""


class Live(Struct, frozen=True, gc=False, kw_only=True, forbid_unknown_fields=True):
    """The last live pose of a tracked entity, received `age_s` seconds ago and measured at `stamp_ns`.

    `stale` means that no pose was received for longer than `semmap up --stale`; the last one is used.
    """

    pose: Pose
    stamp_ns: int
    age_s: float
    source: Tracking
    stale: bool = False


class Entity(Struct, frozen=True, gc=False, kw_only=True, forbid_unknown_fields=True):
    """One individual of the map with a position: an object, a person, a wall, or a place.

    Class names are local names of the TBox (`Chair`). `types` has all asserted and inferred classes.

    `size_m` is the extent along its own axes [m]. In commits and publications, it is the asserted size or
    None. Replies fill in the size of the body or of the model. Without a model it is None: the size is
    unknown, and the scene shows a box.

    `tracked` is the source of live poses, or "". For tracked entities, `pose` is the last committed pose, and
    `live`, which replies fill in, is the newest.

    There is one provenance each for the pose, for the shape (class or size) and for the labels
    (`reference_provenance`). `joint_provenance` is for openness and joint positions, `switch_provenance` for
    switches, and `grip_provenance` for the attachment; these are None if never set. `properties` are the
    asserted data and object properties.

    Individuals that are not in space (`in_space` is false) are only in the replies of `get` and `list`. Their
    provenance has commit 0, because commits are dated by entity.
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
    """An observation that contradicts an operator's assertion, which is kept; empty if there is none."""
    properties: dict[str, Stated] = {}
    """Other asserted properties, by name: `{"isOpen": true, "hasColor": ["color_red"]}`.

    `sameAs` has the names of the individuals that are the same, by assertion or inference.
    """
    in_space: bool = True
    """False for other individuals, such as persons of an address book: these have neither pose nor body."""
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
    def other_names(self) -> tuple[str, ...]:
        """The names of equal individuals, which also refer to this entity."""
        names = self.properties.get(SAME_AS, ()) if self.properties else ()
        return tuple(map(str, names)) if isinstance(names, tuple) else (str(names),)

    @property
    def joints_said(self) -> Provenance | None:
        """The provenance of the last change of any joint or switch position, or None."""
        both = (self.joint_provenance, self.switch_provenance)
        return max((p for p in both if p is not None), key=lambda p: p.commit, default=None)


class ClassInfo(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A named class of the TBox.

    `name` is the local name of its IRI, or `prefixed` if other classes have the same local name.
    """

    name: str
    iri: str
    prefixed: str = ""
    """The name with its prefix, which is unique: `dm:Chair`."""
    parents: tuple[str, ...]
    ancestors: tuple[str, ...]
    labels: dict[str, str]
    """Language tag (or "") to text, one per language."""
    also: tuple[str, ...] = ()
    """Further labels."""
    comment: str = ""
    spatial: bool
    """Whether its instances are physical things, which can be added to the map."""
    place: bool
    fixed: bool
    model: str
    asserted: int = 0
    """The number of entities that are asserted to be of this class."""
    inferred: int = 0
    """The number of entities of this class, including inferred ones."""


class RuleInfo(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A SWRL rule of the TBox."""

    name: str
    """Its label or the name in its IRI, or ""."""
    text: str
    """The rule as a sentence; empty if it is not supported."""
    holds: int
    """The number of combinations of individuals and values for which its conditions hold now."""
    at_least: bool = False
    """Whether counting was stopped at the time limit, so that there may be more."""
    unsupported: str = ""
    """The reason why the rule has no effect, or ""."""


class PropertyInfo(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A data or object property of the TBox that can be set for an entity."""

    name: str
    iri: str
    kind: Literal["data", "object"]
    functional: bool
    """Whether it has at most one value, so that a new value replaces the previous one."""
    domain: tuple[str, ...]
    range: tuple[str, ...]
    """Datatypes, restricted ones in words, or classes; empty if there is no restriction."""
    datatypes: tuple[str, ...] = ()
    """The datatypes of the values of a data property: `float` for a number from 0 to 1."""
    labels: dict[str, str]
    """Language tag (or "") to text."""
    comment: str = ""
    values: dict[str, str]
    """The individuals of the TBox that can be its value, by name, with their labels."""
