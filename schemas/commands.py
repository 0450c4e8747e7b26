"""The commands. Each is a Struct with a name and a reply type: `class Get(Command[Entity], tag="get")`.

The fields are the same on the command line (`semmap add Chair --at 1 2 0`), in a selector
(`semmap/cmd/add?class=Chair;at=1,2,0`) and in a message (`{"verb": "add", "class": "Chair", ...}`).
Positions and sizes are in metres in the map frame, angles in radians, or texts such as `90deg`.
"""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Final, Literal

from msgspec import Meta, field, structs

from semmap.schemas import errors
from semmap.schemas.approvals import Consequences, Request
from semmap.schemas.backups import BackupPart
from semmap.schemas.calls import DOCUMENT, MANY, Call, R
from semmap.schemas.entities import (
    Angle,
    ClassInfo,
    Entity,
    Name,
    Probability,
    PropertyInfo,
    Quaternion,
    Remark,
    RuleInfo,
    Size,
    Source,
    Text,
    Tracking,
    Value,
    Vector,
    Word,
    composed,
    parse_angle,
)
from semmap.schemas.exemplars import LessonTold, ShownView
from semmap.schemas.explanations import Explanation
from semmap.schemas.frames import Frame, FrameName
from semmap.schemas.language import Account, Found, Language, Understood
from semmap.schemas.map_history import Difference, Spells, Trail
from semmap.schemas.moments import When
from semmap.schemas.plans import HEIGHTS_M, RADIUS_M, Clearance, HeightRange, Plan, Way
from semmap.schemas.relations import Described, Relation, ViewPoint, Where
from semmap.schemas.replies import (
    Changed,
    Checked,
    Compacted,
    Document,
    Done,
    Inferred,
    LoggedCommit,
    Moved,
    Possible,
    Sighting,
    SystemStatus,
)
from semmap.schemas.role_names import ADMINS, ANYBODY, NODES, OBSERVERS, OPERATORS, Roles
from semmap.schemas.scenes import Picture, Point
from semmap.schemas.sparql import SparqlResult, Watching

__all__ = [
    "Add",
    "Approve",
    "Attach",
    "Backup",
    "Batch",
    "Check",
    "Classes",
    "Clear",
    "Close",
    "Command",
    "Compact",
    "Could",
    "Detach",
    "Diff",
    "Drive",
    "Explain",
    "Export",
    "Find",
    "FindTrail",
    "FindWay",
    "Forget",
    "Get",
    "History",
    "Infer",
    "LastSeen",
    "Learn",
    "Learned",
    "List",
    "ListFrames",
    "Load",
    "Move",
    "Open",
    "Pause",
    "PlanFloor",
    "Properties",
    "Relations",
    "Remove",
    "Rename",
    "Renew",
    "Reset",
    "Rules",
    "Set",
    "Sparql",
    "Status",
    "StepOnce",
    "Submit",
    "TakePicture",
    "Tell",
    "Track",
    "Understand",
    "Undo",
    "Unset",
    "Update",
    "WasWhen",
    "Watch",
]
"""The names of `semmap.commands`: the commands that programs may send. A test names a missing one."""

RDF_FORMATS = ("rdfxml", "turtle", "ntriples", "jsonld", "functional", "manchester")
RdfFormat = Literal["rdfxml", "turtle", "ntriples", "jsonld", "functional", "manchester"]
"""RDF syntaxes, and OWL's functional and Manchester syntax."""
ListFormat = Literal["json", "lu4r", "legacy"]
ExtentText = Annotated[str, Meta(min_length=1, max_length=50_000)]
"""The area of a place, seen from above: `POLYGON ((x y, ...))` in WKT; see `semmap.schemas.polygons`."""
ClassName = Annotated[str, Meta(min_length=1, max_length=200)]
Since = Annotated[int, Meta(ge=0, le=1 << 53)]
"""A commit number: the command is rejected if a later commit changed an entity in `unchanged`."""


SHAPES_BYTES: Final = 10 << 20
"""The maximum size of a document with SHACL shapes [bytes]."""
_SLOW: Final = frozenset(
    {"load", "clear", "undo", "check", "infer", "export", "compact", "watch", "step", "drive"}
)
"""Commands that can take long, or that are not idempotent."""


class Command(
    Call[R], frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="verb", omit_defaults=True
):
    """The base of all commands; a `Command[R]` has the reply type R.

    A command that is sent twice with the same `id` is executed once; both requests get the same reply.
    """

    ROLES: ClassVar[Roles] = NODES
    """The roles that may send the command; each command sets its own."""

    id: Annotated[str, Meta(max_length=200)] = ""
    source: Source = "operator"
    agent: Annotated[str, Meta(max_length=200)] = ""
    reason: Remark = ""

    @property
    def is_quick(self) -> bool:
        """Whether the command is short and can safely be sent again."""
        return self.VERB not in _SLOW

    def __post_init__(self) -> None:
        """Convert the name to Unicode's composed form, in which names are compared, and `yaw` to radians."""
        if isinstance(name := getattr(self, "name", None), str) and not name.isascii():
            structs.force_setattr(self, "name", composed(name))
        if (yaw := getattr(self, "yaw", None)) is not None:
            try:
                structs.force_setattr(self, "yaw", parse_angle(yaw))
            except ValueError as error:
                raise errors.BadRequest(str(error)) from None


# Changes


class Add(Command[Changed], frozen=True, tag="add"):
    """Add an entity to the map.

    Without `name`, one is generated from the class. With `on`, `in` or `next_to` it is placed where there is
    room on, in or next to another entity, aligned with it. Without these and `at`, the entity is placed at
    the next free position near the default pose. With `default`, the class's label becomes its label. `set`
    are properties, each written `PROPERTY=VALUE`. With `track` it is tracked from the start (see `Track`).
    `wait` delays the reply until its body is in the scene.

    `extent` is for places. Then only the z of `at` (the height of the floor) and the z of `size` (the height
    of the place) are used. With a `frame` (see `frames`), `at` and the angle are in that frame; without an
    angle, only the position is.

    Like every command that changes entities, it is rejected with PreconditionFailed if an entity in
    `unchanged` was removed, or changed by a commit after `since`.
    """

    ROLES: ClassVar[Roles] = OBSERVERS

    class_: ClassName = field(name="class")
    name: Name | None = None
    at: Vector | None = None
    yaw: Angle | None = None
    orientation: Quaternion | None = None
    frame: FrameName | None = None
    size: Size | None = None
    extent: ExtentText | None = None
    ref: Text | None = None
    alt: tuple[Text, ...] = ()
    confidence: Probability | None = None
    default: bool = False
    wait: bool = False
    set: tuple[Text, ...] = ()
    track: Tracking | None = None
    unchanged: tuple[Word, ...] = ()
    since: Since = 0
    dry_run: bool = False
    on: Word | None = None
    in_: Word | None = field(name="in", default=None)
    next_to: Word | None = None


class Update(Command[Changed], frozen=True, tag="update"):
    """Change an entity; omitted fields keep their values. `alt` replaces all aliases.

    `conflict` records an observation that contradicts the map, which stays unchanged; an empty text clears
    it. `set` and `unset` are properties, written `PROPERTY=VALUE`, or `PROPERTY` to unset all values. Both
    for one property replace its values. A class that would turn an object into a place, or a place into an
    object, is rejected without `force`.

    With `carry`, objects on the entity or inside it move with it as one rigid body, in the same commit. The
    objects in `leave`, and what is on them, do not move. `extent` and `frame` are as for `add`; a place with
    an extent is moved by setting a new one. `on`, `in` and `next_to` are as for `add`, but without an angle
    it keeps its orientation.

    Of an individual that is not in space, given by its name or IRI, only the class, the labels and the
    properties can be updated.
    """

    ROLES: ClassVar[Roles] = OBSERVERS

    name: Word
    class_: ClassName | None = field(name="class", default=None)
    at: Vector | None = None
    yaw: Angle | None = None
    orientation: Quaternion | None = None
    frame: FrameName | None = None
    size: Size | None = None
    extent: ExtentText | None = None
    ref: Text | None = None
    alt: tuple[Text, ...] | None = None
    conflict: Remark | None = None
    confidence: Probability | None = None
    wait: bool = False
    set: tuple[Text, ...] = ()
    unset: tuple[Text, ...] = ()
    force: bool = False
    carry: bool = False
    leave: tuple[Word, ...] = ()
    unchanged: tuple[Word, ...] = ()
    since: Since = 0
    dry_run: bool = False
    on: Word | None = None
    in_: Word | None = field(name="in", default=None)
    next_to: Word | None = None


class Set(Command[Changed], frozen=True, tag="set"):
    """Set a data or object property of an entity, by its name or label, e.g. `set door1 isOpen false`.

    The property's range determines the type of the values: true or false, numbers, texts (`rosso@it` has a
    language), individuals by name. A functional property's value is replaced; other properties get an
    additional value. The name may be a label or class that only one entity has. An individual that is not in
    space is given by its name or IRI. The command is rejected
    with PreconditionFailed unless `if_is` is a current value, or with `if_unset` unless the property has
    none.
    """

    ROLES: ClassVar[Roles] = OBSERVERS

    name: Word
    property: Text
    values: tuple[Value, ...]
    if_is: Value | None = None
    if_unset: bool = False
    confidence: Probability | None = None
    unchanged: tuple[Word, ...] = ()
    since: Since = 0
    dry_run: bool = False


class Unset(Command[Changed], frozen=True, tag="unset"):
    """Remove one value of an entity's property, or all of them; `name` and `if_is` as for `set`."""

    ROLES: ClassVar[Roles] = OBSERVERS

    name: Word
    property: Text
    value: Value | None = None
    if_is: Value | None = None
    unchanged: tuple[Word, ...] = ()
    since: Since = 0
    dry_run: bool = False


class Rename(Command[Changed], frozen=True, tag="rename"):
    """Rename an entity, in one commit: all references to it in the map refer to the `new` name.

    Its body in the scene is replaced by one with the new name. The command is rejected for tracked entities,
    for attached ones and those that others are attached to, for robots, and for bodies of the world file.
    """

    ROLES: ClassVar[Roles] = OPERATORS

    name: Word
    new: Name
    unchanged: tuple[Word, ...] = ()
    since: Since = 0
    dry_run: bool = False

    def __post_init__(self) -> None:
        """Convert the names to Unicode's composed form."""
        super().__post_init__()
        structs.force_setattr(self, "new", composed(self.new))


class Track(Command[Changed], frozen=True, tag="track"):
    """Track an entity's pose live: from a publisher (`stream`) or from the simulator (`sim`).

    Live poses are published on `semmap/live/<name>`, and the newest is used. A pose is committed only when
    the entity stops. With `off`, tracking ends, and the entity stays at its last pose.
    """

    ROLES: ClassVar[Roles] = OPERATORS

    name: Word
    from_: Tracking = field(name="from", default="stream")
    off: bool = False
    unchanged: tuple[Word, ...] = ()
    since: Since = 0
    dry_run: bool = False


class Attach(Command[Changed], frozen=True, tag="attach"):
    """Attach an entity to another one, such as a robot's gripper or a tray, and move it with that.

    It is attached at its current pose, or `at` a position in the frame of `to` (whose origin is the bottom
    centre [m]), rotated by `yaw` [rad]. The commit contains the pose and the properties `isGraspedBy` and
    `graspPose`. The command is rejected for places, for fixed, nested and already attached entities, and for
    an entity that `to` is attached to. It is also rejected for an entity more than 0.3 m away from `to`,
    without `at` or `force`.

    With `carry`, objects on the entity or inside it are attached to it at their current poses, until it is
    detached. Objects in `leave`, and objects that only they support, stay.
    """

    ROLES: ClassVar[Roles] = OPERATORS

    name: Word
    to: Word
    at: Vector | None = None
    yaw: Angle | None = None
    carry: bool = False
    leave: tuple[Word, ...] = ()
    force: bool = False
    unchanged: tuple[Word, ...] = ()
    since: Since = 0
    dry_run: bool = False


class Detach(Command[Changed], frozen=True, tag="detach"):
    """Detach an entity at its current pose, which is committed.

    Objects that were attached with it (`carry`) are detached, too.
    """

    ROLES: ClassVar[Roles] = OPERATORS

    name: Word
    unchanged: tuple[Word, ...] = ()
    since: Since = 0
    dry_run: bool = False


class Batch(Command[Changed], frozen=True, tag="batch"):
    """Change several entities in one commit: all changes are applied or, if one is rejected, none.

    `changes` are `update`, `set` and `unset` in any order, as they are applied together. An entity is updated
    at most once, and each of its properties is set or unset at most once. `source`, `agent`, `reason`,
    `confidence`, `unchanged`, `since` and `dry_run` belong to the batch. Positions are in the map frame.
    """

    ROLES: ClassVar[Roles] = OBSERVERS
    LARGEST: ClassVar[int] = MANY

    changes: Annotated[tuple[Update | Set | Unset, ...], Meta(max_length=10_000)]
    confidence: Probability | None = None
    unchanged: tuple[Word, ...] = ()
    since: Since = 0
    dry_run: bool = False


class Remove(Command[Changed], frozen=True, tag="remove"):
    """Remove entities from the map and the scene: all of them or, if a name is unknown, none.

    Individuals that are not in space are given by their names or IRIs.
    """

    ROLES: ClassVar[Roles] = OBSERVERS
    LARGEST: ClassVar[int] = MANY

    names: tuple[Word, ...]
    unchanged: tuple[Word, ...] = ()
    since: Since = 0
    dry_run: bool = False

    def __post_init__(self) -> None:
        """Convert the names to Unicode's composed form."""
        structs.force_setattr(self, "names", tuple(map(composed, self.names)))


class Clear(Command[Changed], frozen=True, tag="clear"):
    """Remove all entities from the map and the scene. The TBox stays."""

    ROLES: ClassVar[Roles] = OPERATORS

    dry_run: bool = False


class Load(Command[Changed], frozen=True, tag="load"):
    """Load a file: an ABox, a scene in JSON or a HuRIC map; the format is detected from the content.

    What the file states about an entity that is in the map replaces its pose, size, labels and values of
    functional properties; with `add_only`, such a file is rejected. `replace` removes the present entities in
    the same commit. `skip_unknown` skips entities of classes that the TBox lacks; otherwise one such entity
    causes the file to be rejected. `graph` is the named graph of a TriG, N-Quads or JSON-LD file to load in
    place of its default graph. `urdf` is a URDF file: the individuals that are called like its links get
    their poses and sizes, if the file does not state them. `strict` rejects a file that refers to undefined
    individuals; otherwise they are reported in a note. With `tbox`, the file is a TBox that replaces the
    present one, unless the map is invalid under it; with `extend`, its statements are added to the present
    TBox. `spatial_root` are the classes whose instances are physical things, if the TBox does not show it.

    With `tbox_from_abox`, the classes, properties and axioms that a map's file declares are added to the TBox
    in the same commit. Otherwise they are statements of the map.

    A file is loaded in one commit, or with `parts` in several commits, which bounds the memory. If a part is
    rejected, the earlier parts stay, and the error reports them.
    """

    ROLES: ClassVar[Roles] = OPERATORS
    LARGEST: ClassVar[int] = DOCUMENT

    content: bytes
    filename: Annotated[str, Meta(max_length=5000)] = ""
    replace: bool = False
    add_only: bool = False
    skip_unknown: bool = False
    strict: bool = False
    tbox: bool = False
    spatial_root: tuple[ClassName, ...] = ()
    parts: bool = False
    dry_run: bool = False
    extend: bool = False
    graph: Annotated[str, Meta(max_length=5000)] = ""
    urdf: bytes = b""
    tbox_from_abox: bool = False


# Queries


class List(Command[tuple[Entity, ...] | dict[str, Any]], frozen=True, tag="list"):
    """List the entities of a class (or all), using inferred types; with `as_of`, at that time.

    The list is restricted to entities that are `on` an object (directly or indirectly), `in` a place or a
    container, `near` an object or `within` so many metres of it, or to the `nearest` ones `to` it. These
    relations are computed from poses, sizes and shapes. Objects and places are given by name, label or class;
    `near` (with `within`) and `to` can also be positions, written `2.5,1,0.8` [m]. With a `frame`, these
    positions and the poses in the reply are in that frame. The reply contains the entities, or a document if
    the format is not `json`.

    With `all`, the individuals that are not in space follow the entities: those that the map describes, not
    those of its TBox. Their `in_space` is false. `class` can then be a class that only the map uses.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    class_: ClassName | None = field(name="class", default=None)
    format: ListFormat = "json"
    as_of: When | None = None
    on: Text | None = None
    in_: Text | None = field(name="in", default=None)
    near: Text | None = None
    within: Annotated[float, Meta(gt=0.0, le=20_000.0)] | None = None
    nearest: Annotated[int, Meta(ge=1, le=10_000)] | None = None
    to: Text | None = None
    frame: FrameName | None = None
    all: bool = False

    @property
    def where(self) -> Where | None:
        """The spatial conditions, if there are any."""
        where = Where(
            on=self.on, in_=self.in_, near=self.near, within=self.within, nearest=self.nearest, to=self.to
        )
        return None if where == Where() else where


class Relations(Command[tuple[Relation, ...]], frozen=True, tag="relations"):
    """Compute the spatial relations of an entity; with `other`, also the relations that do not hold.

    `name`, `other` and `viewer` are names, or labels or classes of only one entity. `viewer` or `viewpoint`
    adds left of, right of, in front of and behind, as seen from there.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    name: Word
    other: Word | None = None
    viewer: Word | None = None
    viewpoint: ViewPoint | None = None
    as_of: When | None = None


class Get(Command[Described], frozen=True, tag="get"):
    """Get one entity; with `as_of`, at that time.

    With `where`, the reply also contains what it is on, inside and in, and asserted relations that do not
    hold (only for the current map). With a `frame`, its current pose is given in that frame.

    An individual that is not in space, such as a person of an address book, is given by its name or IRI. The
    reply then contains what refers to it (only for the current map).
    """

    ROLES: ClassVar[Roles] = ANYBODY

    name: Word
    as_of: When | None = None
    where: bool = False
    frame: FrameName | None = None


class ListFrames(Command[tuple[Frame, ...]], frozen=True, tag="frames"):
    """List the tree of frames; with a `name`, that frame with its ancestors and descendants.

    The frames are `map`, every entity with a position, the simulator's cameras, and frames published on
    `semmap/frame/<name>`. Parents precede their children.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    name: Word | None = None


class Check(Command[Checked], frozen=True, tag="check"):
    """Check whether the map is consistent, and explain why not. `owlrl` is a slow, independent reasoner.

    The facts are also validated against the SHACL shapes of the map and its TBox, and those of the document
    `shapes`, whose name is `filename`.
    """

    ROLES: ClassVar[Roles] = ANYBODY
    LARGEST: ClassVar[int] = 2 * SHAPES_BYTES  # with base64 in JSON, and the name

    engine: Literal["semmap", "owlrl"] = "semmap"
    shapes: bytes = b""
    filename: Annotated[str, Meta(max_length=5000)] = ""


class Infer(Command[Inferred], frozen=True, tag="infer"):
    """List the inferred facts about one individual, or about all entities."""

    ROLES: ClassVar[Roles] = ANYBODY

    name: Word | None = None


class Explain(Command[Explanation], frozen=True, tag="explain"):
    """Explain why a triple holds, or with `negated` why it cannot hold.

    `name`, `predicate` and `value` are local names, labels, IRIs in <> or literals. Triples that no rule
    derives are decided by refutation: two individuals are different if identity would be a contradiction.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    name: Word
    predicate: Word
    value: str
    negated: bool = False


class Could(Command[Possible], frozen=True, tag="could"):
    """Test whether a triple would be consistent with the map, and explain why not. The map is not changed.

    `name`, `predicate` and `value` are written as for `Explain`. The property's range determines the type of
    a data property's value.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    name: Word
    predicate: Word
    value: str


class Diff(Command[Difference], frozen=True, tag="diff"):
    """List what changed between `since` and `until` (or now), which are commits or times.

    A minute or a day counts from its beginning as `since`, and up to its end as `until`.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    since: When
    until: When | None = None
    on: Text | None = None
    in_: Text | None = field(name="in", default=None)


class WasWhen(Command[Spells], frozen=True, tag="when"):
    """List when an entity was on, inside, in, near or attached to another, as computed after each commit.

    `relation` may also be a property and `other` its value: `isOpen`, `false`. The value is true by default.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    name: Word
    relation: Word
    other: Value = True


class FindTrail(Command[Trail], frozen=True, tag="trail"):
    """Return when tracked entities entered and left places by their live poses, and where they were.

    `name` may be a label or class of several. `in` selects visits of a place, `since` and `until` (inclusive)
    a period, `at` a time. Of the visits, the newest `limit` are returned. The track is thinned to `points`
    positions.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    name: Word
    since: When | None = None
    until: When | None = None
    at: When | None = None
    in_: Text | None = field(name="in", default=None)
    limit: Annotated[int, Meta(ge=1, le=10_000)] = 100
    points: Annotated[int, Meta(ge=0, le=10_000)] = 1000


class Tell(Command[Account], frozen=True, tag="tell"):
    """Describe the map, a place or a thing in a text of at most `words` words.

    The most important facts come first, similar things are counted together, and omissions are reported. With
    `as_of`, it is the map of that time.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    name: Word | None = None
    words: Annotated[int, Meta(ge=20, le=5000)] = 150
    as_of: When | None = None


class Understand(Command[Understood], frozen=True, tag="understand"):
    """Parse a natural-language command to semantic frames, with roles filled by entities of the map.

    Without a `language`, it is detected.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    text: Text
    language: Language | None = None


class Find(Command[Found], frozen=True, tag="find"):
    """Find the entities that a noun phrase describes: "the red cup on the kitchen table".

    `viewer` (a name, or a label or class of only one entity) or `viewpoint` defines left, right and behind.
    "My" refers to `asker`. `answer` answers the clarification question about `text`: "the one on the desk".
    With `as_of`, the entities are those of the map at that time.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    text: Text
    viewer: Word | None = None
    viewpoint: ViewPoint | None = None
    asker: Word | None = None
    answer: Text | None = None
    as_of: When | None = None


class PlanFloor(Command[Plan], frozen=True, tag="floorplan"):
    """Return the outlines of places, things and walls, seen from above; with `as_of`, at that time.

    The command line converts them to occupancy grids, SVG and GeoJSON.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    as_of: When | None = None


class FindWay(Command[Way], frozen=True, tag="route"):
    """Plan the shortest path for a robot of a `radius` [m] over places and through doors.

    `from` and `to` are places, things, persons (by name, label or class) or positions, written `2.5,1` [m].
    Objects with a part within `heights` [m] above the floor, and forbidden places, are obstacles. If the path
    leads through closed doors, the reply lists them. Raises Refused, with the reason, if there is no path.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    from_: Word = field(name="from")
    to: Word
    radius: Clearance = RADIUS_M
    heights: HeightRange = HEIGHTS_M
    as_of: When | None = None


class Export(Command[Document], frozen=True, tag="export"):
    """Export the map as a document, after a consistency check; with `inferred`, including inferred facts.

    With `as_of`, the map of that time is exported; its inferred and computed facts are computed again.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    format: RdfFormat = "rdfxml"
    inferred: bool = False
    as_of: When | None = None


class Classes(Command[tuple[ClassInfo, ...]], frozen=True, tag="classes"):
    """List the classes of the TBox, with the number of entities of each."""

    ROLES: ClassVar[Roles] = ANYBODY


class Properties(Command[tuple[PropertyInfo, ...]], frozen=True, tag="properties"):
    """List the data and object properties of the TBox that `set` accepts, with their ranges and labels."""

    ROLES: ClassVar[Roles] = ANYBODY


class Rules(Command[tuple[RuleInfo, ...]], frozen=True, tag="rules"):
    """List the SWRL rules of the TBox as sentences, with how often each holds now."""

    ROLES: ClassVar[Roles] = ANYBODY


class Status(Command[SystemStatus], frozen=True, tag="status"):
    """Return the state of the nodes, the map and the scene, and any problems.

    With `names`, `in_agreement`, `pending` and `displaced` cover only these entities.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    names: tuple[Word, ...] = ()


# History and undo


class History(Command[tuple[LoggedCommit, ...]], frozen=True, tag="history"):
    """List the newest commits, or those that changed an entity, from `since` to `until` (inclusive).

    `by` selects an author: an agent (`anna`), a source (`perception`) or both (`perception/camera1`). `in`
    selects the commits that changed something that was in this place or container before or after them, and
    `on` something that was on this object.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    name: Word | None = None
    since: When | None = None
    until: When | None = None
    limit: Annotated[int, Meta(ge=1, le=10_000)] = 100
    by: Text | None = None
    in_: Text | None = field(name="in", default=None)
    on: Text | None = None


class LastSeen(Command[Sighting], frozen=True, tag="last-seen"):
    """Return when, where and by whom an entity was last seen or placed, even if it has been removed.

    The reply distinguishes entities that were observed to be absent from those not observed since.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    name: Word


class Undo(Command[Changed], frozen=True, tag="undo"):
    """Undo a commit by a new one, unless later ones depend on it; the scene is updated.

    Without `commit`, the newest commit that a client requested is undone, with the settling that followed it.
    A `move`, `open`, `close` or `drive` that is not committed yet is stopped instead of undoing a commit.
    """

    ROLES: ClassVar[Roles] = OPERATORS

    commit: Annotated[int, Meta(ge=1, le=1 << 53)] | None = None
    dry_run: bool = False


# Approval of agents' changes


class Submit(Command[Request], frozen=True, tag="submit"):
    """Request a person's approval of a change; sent again with the same `id`, it returns the decision.

    `text` describes the change and `follows` its consequences, one per line. Approval does not lock the map:
    the agent that submitted the change makes it after the approval. With `withdraw`, the pending request with
    this `id` is deleted, and a decided one stays.
    """

    ROLES: ClassVar[Roles] = OPERATORS

    text: Annotated[str, Meta(min_length=1, max_length=2000)]
    follows: Annotated[Consequences, Meta(max_length=200)] = ()
    withdraw: bool = False


class Approve(Command[tuple[Request, ...]], frozen=True, tag="approve"):
    """List the pending requests of agents; with a `number`, approve or (with `reject`) reject that one.

    `reject` with `all` rejects all pending requests.
    """

    ROLES: ClassVar[Roles] = OPERATORS

    number: Annotated[int, Meta(ge=1, le=1 << 53)] | None = None
    reject: bool = False
    all: bool = False


# Storage


class Backup(Command[BackupPart], frozen=True, tag="backup"):
    """Return a part of a backup of the map with its history: the first, or the one `at` a part's `next`.

    The concatenated parts are the backup file as of the first part, even if the map changes meanwhile: see
    `schemas/backups.py`.
    """

    ROLES: ClassVar[Roles] = ADMINS

    at: str = ""


class Compact(Command[Compacted], frozen=True, tag="compact"):
    """Replace the commits that are older than `keep` (`12h`, `30d`) by a snapshot.

    The history begins there afterwards: earlier commits cannot be queried or undone. With `dry_run`, nothing
    is changed, and the reply contains what would be removed.
    """

    ROLES: ClassVar[Roles] = ADMINS

    keep: str = "30d"
    dry_run: bool = False


# SPARQL


QueryText = Annotated[str, Meta(min_length=1, max_length=100_000)]
RowLimit = Annotated[int, Meta(ge=1, le=100_000)]
TimeLimit = Annotated[float, Meta(gt=0.0, le=60.0)]


class Sparql(Command[SparqlResult], frozen=True, tag="sparql"):
    """Run a SPARQL 1.1 query over asserted and, with `inferred`, inferred facts; with `as_of`, at that time.

    Queries are read-only. A query that takes longer than `timeout` [s] or returns more than `limit` rows is
    rejected.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    query: QueryText
    inferred: bool = False
    as_of: When | None = None
    timeout: TimeLimit = 5.0
    limit: RowLimit = 10_000


class Watch(Command[Watching], frozen=True, tag="watch"):
    """Start a standing query: returns its current rows; changes are published on `semmap/jena/query/<watch>`.

    It is a SELECT `query`, or the entities that are `on`, `in` or `near` something (`within` so many metres),
    as for `List`; then each row is an entity's IRI.

    `watch` is its name (generated if omitted); a client that subscribes to the key first misses no change.
    The query is evaluated again when a commit may affect it, and ends `lease` seconds after the last `renew`.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    query: QueryText | None = None
    inferred: bool = False
    class_: ClassName | None = field(name="class", default=None)
    on: Text | None = None
    in_: Text | None = field(name="in", default=None)
    near: Text | None = None
    within: Annotated[float, Meta(gt=0.0, le=20_000.0)] | None = None
    watch: Name | None = None
    lease: Annotated[float, Meta(ge=1.0, le=3600.0)] = 30.0

    @property
    def where(self) -> Where | None:
        """The spatial conditions, if there are any."""
        where = Where(on=self.on, in_=self.in_, near=self.near, within=self.within)
        return None if where == Where() else where


class Renew(Command[Done], frozen=True, tag="renew"):
    """Renew the lease of a standing query or, with `end`, end it."""

    ROLES: ClassVar[Roles] = ANYBODY

    watch: Name
    end: bool = False


# Scene and perception


class Move(Command[Moved], frozen=True, tag="move"):
    """Move the body of an entity; its pose is committed when the body comes to rest.

    With `carry`, the bodies of objects on it or inside it (according to the map) move with it as one rigid
    body and are committed together, except those in `leave`. `frame` is as for `add`. `wait` delays the reply
    until the commit exists, or until it is certain that there is none; it has no effect while time is paused.
    Exactly one of `at`, `on`, `in` and `next_to` is required; see `update`.
    """

    ROLES: ClassVar[Roles] = OPERATORS

    name: Word
    at: Vector | None = None
    yaw: Angle | None = None
    frame: FrameName | None = None
    carry: bool = False
    leave: tuple[Word, ...] = ()
    wait: bool = False
    on: Word | None = None
    in_: Word | None = field(name="in", default=None)
    next_to: Word | None = None


class Open(Command[Moved], frozen=True, tag="open"):
    """Open an object: its joints move to the share `to` of their range; the map is updated when they stop.

    With a `joint`, only that joint moves. Raises Refused for an object without joints and NoAnswer without a
    simulator. `wait` delays the reply until the joints stop and the map is updated, as for `move`. Obstacles
    stop the movement.
    """

    ROLES: ClassVar[Roles] = OPERATORS

    name: Word
    to: Probability = 1.0
    joint: Word | None = None
    wait: bool = False


class Close(Command[Moved], frozen=True, tag="close"):
    """Close an object; as for `open`."""

    ROLES: ClassVar[Roles] = OPERATORS

    name: Word
    joint: Word | None = None
    wait: bool = False


class Drive(Command[Moved], frozen=True, tag="drive"):
    """Drive a robot of the simulator through one or more points, in a straight line to each.

    At the end it turns to `yaw`. Points and `yaw` are in the map frame, or in `frame` at its pose when the
    command starts. The robot first turns towards each point and drives at most at `speed` [m/s]. `stop` stops
    it at its current position. `wait` delays the reply until it has arrived and the map is updated, as for
    `move`. Raises Refused if the robot is blocked or falls over.
    """

    ROLES: ClassVar[Roles] = OPERATORS

    name: Word
    to: tuple[Point, ...] = ()
    yaw: Angle | None = None
    frame: FrameName | None = None
    speed: Annotated[float, Meta(gt=0.0, le=2.0)] = 0.4
    stop: bool = False
    wait: bool = False


class Learn(Command[LessonTold], frozen=True, tag="learn"):
    """Teach perception an object of a class, from the current view of an `entity` or from `views`.

    Perception recognises the object from then on. The class can be new to perception, but must be in the
    TBox. `shown` describes the origin of the views.
    """

    ROLES: ClassVar[Roles] = OPERATORS

    class_: ClassName = field(name="class")
    entity: Word | None = None
    views: Annotated[tuple[ShownView, ...], Meta(max_length=200)] = ()
    shown: Remark = ""


class Learned(Command[tuple[LessonTold, ...]], frozen=True, tag="learned"):
    """List the exemplars that perception was taught, in order."""

    ROLES: ClassVar[Roles] = ANYBODY


class Forget(Command[LessonTold], frozen=True, tag="forget"):
    """Remove an exemplar of perception."""

    ROLES: ClassVar[Roles] = OPERATORS

    number: Annotated[int, Meta(ge=1)]


class Pause(Command[Done], frozen=True, tag="pause"):
    """Pause simulated time, or resume it with `off`."""

    ROLES: ClassVar[Roles] = OPERATORS

    off: bool = False


class StepOnce(Command[Done], frozen=True, tag="step"):
    """Advance paused time by `seconds`; rejected while time is running."""

    ROLES: ClassVar[Roles] = OPERATORS

    seconds: Annotated[float, Meta(gt=0.0, le=60.0)] = 0.1


class Reset(Command[Done], frozen=True, tag="reset"):
    """Move every body to its pose in the map."""

    ROLES: ClassVar[Roles] = OPERATORS


class TakePicture(Command[Picture], frozen=True, tag="picture"):
    """Render the scene, from one of the world's cameras or from above, or render one `place`.

    With `labels`, the image shows the names of the entities.
    """

    ROLES: ClassVar[Roles] = ANYBODY

    camera: Word | None = None
    place: Word | None = None
    labels: bool = False
    width: Annotated[int, Meta(ge=16, le=4096)] = 960
    height: Annotated[int, Meta(ge=16, le=4096)] = 720


COMMANDS: dict[str, type[Command]] = {str(c.__struct_config__.tag): c for c in Command.__subclasses__()}
"""Command name to request type."""

for _name, _command in COMMANDS.items():
    _command.VERB = _name
