"""The commands: one verb, one Struct, one reply type: `class Get(Command[Entity], tag="get")`.

The fields are the words of the command line (`semmap add Chair --at 1 2 0`), of a selector
(`semmap/cmd/add?class=Chair;at=1,2,0`) and of a message (`{"verb": "add", "class": "Chair", ...}`)
alike. Positions and sizes are metres in the map frame, angles are radians.
"""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Final, Literal

from msgspec import Meta, field, structs

from semmap.schemas.approvals import Request, Told
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
    Size,
    Source,
    Text,
    Tracking,
    Value,
    Vector,
    Word,
    composed,
)
from semmap.schemas.explanations import Explanation
from semmap.schemas.frames import Frame, FrameName
from semmap.schemas.happenings import Difference, KeptRelation, Spells
from semmap.schemas.language import Account, Found, Language, Understood
from semmap.schemas.lessons import LessonTold, ShownView
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
from semmap.schemas.scenes import Picture, Point
from semmap.schemas.sparql import SparqlResult, Watching

RDF_FORMATS = ("rdfxml", "turtle", "ntriples", "jsonld")
RdfFormat = Literal["rdfxml", "turtle", "ntriples", "jsonld"]
ListFormat = Literal["json", "lu4r", "legacy"]
ExtentText = Annotated[str, Meta(min_length=1, max_length=50_000)]
"""What a place covers, seen from above: `POLYGON ((x y, ...))` in WKT; see `semmap.schemas.polygons`."""
ClassName = Annotated[str, Meta(min_length=1, max_length=200)]
Since = Annotated[int, Meta(ge=0, le=1 << 53)]
"""A commit: if one after it has changed what is to be `unchanged`, a command is refused."""


_SLOW: Final = frozenset(
    {"load", "clear", "undo", "check", "infer", "export", "compact", "watch", "step", "drive"}
)
"""Commands that may be at work for long, or that do more when they come twice."""


class Command(
    Call[R], frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="verb", omit_defaults=True
):
    """What every command has; one that is answered with an R is a `Command[R]`.

    The same `id` sent twice is executed once, and answered twice with the same result.
    """

    id: Annotated[str, Meta(max_length=200)] = ""
    source: Source = "operator"
    agent: Annotated[str, Meta(max_length=200)] = ""
    reason: Remark = ""

    @property
    def is_quick(self) -> bool:
        """Most are, and what changes the map is done once under its id."""
        return self.VERB not in _SLOW

    def __post_init__(self) -> None:
        """Names are compared in composed form, however they were typed."""
        if isinstance(name := getattr(self, "name", None), str) and not name.isascii():
            structs.force_setattr(self, "name", composed(name))


# To change


class Add(Command[Changed], frozen=True, tag="add"):
    """Add an entity to the map.

    Without `name` one is made from the class; without `at` it goes to the next free place near the default
    pose; with `default` it also gets the class's label as reference. `set` are properties, each written
    `PROPERTY=VALUE`. With `track` it is tracked from the start (see `Track`). `wait` delays the reply until
    its body stands in the scene. `extent` is for places: with it only the z of `at`
    counts, the height of the floor, and the z of `size`, how high the place is. With a `frame` (see `frames`)
    `at` and the angle are in it; without an angle only the position is.

    Like every command that changes entities, it is refused with PreconditionFailed where one of those that
    are to be `unchanged` is gone, or was changed by a commit after `since`.
    """

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


class Update(Command[Changed], frozen=True, tag="update"):
    """Change an entity; omitted fields keep their values. `alt` replaces all alternative references.

    `conflict` says what is seen against the map's word on it, which stays; an empty one takes that back.
    `set` and `unset` are properties, written `PROPERTY=VALUE`, or `PROPERTY` to unset all values; both of one
    property replace its values. A class that would make an object a place, or a place an object, is refused
    without `force`. With `carry`, what stands on the entity or is inside it moves with it as one rigid body,
    in the same commit; not what `leave` names, and what stands on that. `extent` and `frame` are as for
    `add`; who has an extent is moved by another.
    """

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


class Set(Command[Changed], frozen=True, tag="set"):
    """State a data or object property of an entity, by its name or label, e.g. `set door1 isOpen false`.

    Values are typed by the property's range: true or false, numbers, texts (`rosso@it` has a language),
    individuals by name. The value of a functional property replaces the one before; other properties get
    more values. With `if_is` it is refused with PreconditionFailed unless that is a value now, with
    `if_unset` unless there is none.
    """

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
    """Take back one value of an entity's property, or all of them; `if_is` as for `set`."""

    name: Word
    property: Text
    value: Value | None = None
    if_is: Value | None = None
    unchanged: tuple[Word, ...] = ()
    since: Since = 0
    dry_run: bool = False


class Track(Command[Changed], frozen=True, tag="track"):
    """Let an entity's pose come live: from whoever publishes it (`stream`), or from the simulator (`sim`).

    Live poses are on `semmap/live/<name>`, the newest wins, and only where the entity stops is its pose
    committed. With `off` it is not tracked any more, and stays where it was last.
    """

    name: Word
    from_: Tracking = field(name="from", default="stream")
    off: bool = False
    unchanged: tuple[Word, ...] = ()
    since: Since = 0
    dry_run: bool = False


class Attach(Command[Changed], frozen=True, tag="attach"):
    """Have an entity held by another, such as a robot's gripper or a tray: from now on it goes with that.

    It is held where it is just now, or `at` a position in the frame of its holder (whose origin is the bottom
    centre [m]), turned there by `yaw` [rad]. Where it was taken is committed, and the map states
    `isGraspedBy` and `graspPose`. Refused for places, for what is fixed, part of something or held already,
    and for what holds the holder.

    With `carry`, what stands on the entity or is inside it goes with it, each as it stands there: it is held
    by the entity until that is detached. `leave` names what is not to, nor what only that bears.
    """

    name: Word
    to: Word
    at: Vector | None = None
    yaw: Angle | None = None
    carry: bool = False
    leave: tuple[Word, ...] = ()
    unchanged: tuple[Word, ...] = ()
    since: Since = 0
    dry_run: bool = False


class Detach(Command[Changed], frozen=True, tag="detach"):
    """Let go of what something holds: it is put where it is just now, which is committed.

    What was taken along with it (`carry`) is let go with it.
    """

    name: Word
    unchanged: tuple[Word, ...] = ()
    since: Since = 0
    dry_run: bool = False


class Batch(Command[Changed], frozen=True, tag="batch"):
    """Several changes of entities in one commit: all of them or, where one is refused, none.

    `changes` are `update`, `set` and `unset` in any order, for they happen together: an entity is updated
    once at most, and a property of it is set or unset once. Who makes them and why, `confidence`,
    `unchanged`, `since` and `dry_run` are said of the batch. Positions are in the map frame.
    """

    LARGEST: ClassVar[int] = MANY

    changes: Annotated[tuple[Update | Set | Unset, ...], Meta(max_length=10_000)]
    confidence: Probability | None = None
    unchanged: tuple[Word, ...] = ()
    since: Since = 0
    dry_run: bool = False


class Remove(Command[Changed], frozen=True, tag="remove"):
    """Remove entities from the map and the scene: all of them or, if one is unknown, none."""

    LARGEST: ClassVar[int] = MANY

    names: tuple[Word, ...]
    unchanged: tuple[Word, ...] = ()
    since: Since = 0
    dry_run: bool = False

    def __post_init__(self) -> None:
        """As for `name`."""
        structs.force_setattr(self, "names", tuple(map(composed, self.names)))


class Clear(Command[Changed], frozen=True, tag="clear"):
    """Remove all entities from the map and the scene. The TBox stays."""

    dry_run: bool = False


class Load(Command[Changed], frozen=True, tag="load"):
    """Add what a file describes: an ABox, a scene in JSON or a HuRIC map, told apart by content.

    `replace` takes the present entities out in the same commit. `skip_unknown` leaves out what is of a
    class that the TBox does not have; without it, one such refuses the whole file. `strict` refuses a file
    that relates things to what neither it nor the map describes; without it, that is noted. With `tbox` the
    file is a TBox that replaces the present one, unless the map does not fit it; with `extend`, too, its
    statements are added to the present one. `spatial_root` are classes of it whose instances are things in
    space, where that is not known by itself.

    A file is one commit, or with `parts` as many as it takes, so that memory is bounded by a part's needs;
    when one part is refused, those before it stay, and the error says so.
    """

    LARGEST: ClassVar[int] = DOCUMENT

    content: bytes
    filename: Annotated[str, Meta(max_length=5000)] = ""
    replace: bool = False
    skip_unknown: bool = False
    strict: bool = False
    tbox: bool = False
    spatial_root: tuple[ClassName, ...] = ()
    parts: bool = False
    dry_run: bool = False
    extend: bool = False


# To ask


class List(Command[tuple[Entity, ...] | dict[str, Any]], frozen=True, tag="list"):
    """The entities of a class (all, without one), over inferred types; with `as_of` those of then.

    Of these, those that stand `on` a thing (directly or on what is on it), are `in` a place or a container,
    are `near` a thing or `within` so many metres of it, or the `nearest` so many `to` it; worked out from
    poses, sizes and shapes. Things and places are given by name, reference or class; `near` (with `within`)
    and `to` may be positions instead, written `2.5,1,0.8` [m]. With a `frame` such positions are in it,
    and so are the poses that are answered. Answered with the entities, or with the document of another format
    than `json`.
    """

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

    @property
    def where(self) -> Where | None:
        """What it asks of where things are, if it does."""
        where = Where(
            on=self.on, in_=self.in_, near=self.near, within=self.within, nearest=self.nearest, to=self.to
        )
        return None if where == Where() else where


class Relations(Command[tuple[Relation, ...]], frozen=True, tag="relations"):
    """Where a thing is relative to others, as measured; with `other` also what does not hold of the two.

    `name`, `other` and `viewer` are names, or references or classes that only one thing has. `viewer` or
    `viewpoint` adds left of, right of, in front of and behind, as seen from there.
    """

    name: Word
    other: Word | None = None
    viewer: Word | None = None
    viewpoint: ViewPoint | None = None
    as_of: When | None = None


class Get(Command[Described], frozen=True, tag="get"):
    """One entity; with `as_of` as it was then.

    With `where` also what it is on, inside and in, and what was said of that but does not hold (of the map as
    it is now only). With a `frame` its pose is told in that, as both are just now.
    """

    name: Word
    as_of: When | None = None
    where: bool = False
    frame: FrameName | None = None


class ListFrames(Command[tuple[Frame, ...]], frozen=True, tag="frames"):
    """The tree of frames; with a `name` that frame, those above it and those below it.

    There are `map`, every entity that has a position, the cameras of the simulator, and what others publish
    on `semmap/frame/<name>`. Parents come before their children.
    """

    name: Word | None = None


class Check(Command[Checked], frozen=True, tag="check"):
    """Check whether the map is consistent, and explain why not. `owlrl` is the slow second opinion."""

    engine: Literal["semmap", "owlrl"] = "semmap"


class Infer(Command[Inferred], frozen=True, tag="infer"):
    """The inferred facts about one individual, or about all entities."""

    name: Word | None = None


class Explain(Command[Explanation], frozen=True, tag="explain"):
    """Why a triple holds, or with `negated` why it cannot.

    `name`, `predicate` and `value` are local names, IRIs in <> or literals. What no rule derives is decided
    by refutation: two are different if their being the same would be a contradiction.
    """

    name: Word
    predicate: Word
    value: str
    negated: bool = False


class Could(Command[Possible], frozen=True, tag="could"):
    """Would it be consistent with the map that a triple holds, and if not, why not? Nothing is changed.

    `name`, `predicate` and `value` are written as for `Explain`; the value of a data property is typed by the
    property's range.
    """

    name: Word
    predicate: Word
    value: str


class Diff(Command[Difference], frozen=True, tag="diff"):
    """What changed between `since` and `until` (or now): commits or times."""

    since: When
    until: When | None = None


class WasWhen(Command[Spells], frozen=True, tag="when"):
    """When a thing was on, inside, in or attached to another, as measured after each commit."""

    name: Word
    relation: KeptRelation
    other: Word


class Tell(Command[Account], frozen=True, tag="tell"):
    """What is there, in a text of at most so many `words`: in the map, in a place, or of a thing.

    What matters most is said first, like things are counted together, and what is left out is said to be.
    """

    name: Word | None = None
    words: Annotated[int, Meta(ge=20, le=5000)] = 150


class Understand(Command[Understood], frozen=True, tag="understand"):
    """What a command in words asks for: frames, and which entities of the map fill their roles.

    Without a `language` its words tell which one it is in.
    """

    text: Text
    language: Language | None = None


class Find(Command[Found], frozen=True, tag="find"):
    """Which entities a noun phrase describes: "the red cup on the kitchen table".

    `viewer` (a name, reference or class that only one thing has) or `viewpoint` is who sees what is left,
    right or behind; `asker` is who says "my".
    """

    text: Text
    viewer: Word | None = None
    viewpoint: ViewPoint | None = None
    asker: Word | None = None


class PlanFloor(Command[Plan], frozen=True, tag="floorplan"):
    """Places, things and walls as outlines seen from above; with `as_of` the map as it was then.

    The command line makes occupancy grids, SVG and GeoJSON of it.
    """

    as_of: When | None = None


class FindWay(Command[Way], frozen=True, tag="route"):
    """The shortest way for a robot of a `radius` [m], over places and through doors.

    `from` and `to` are places, things, persons (by name, reference or class) or positions, written `2.5,1`
    [m]. What has a part within `heights` [m] above the floor is in the way, and so are places that are
    forbidden. A way through closed doors names them. Raises Refused, with the reason, where there is none.
    """

    from_: Word = field(name="from")
    to: Word
    radius: Clearance = RADIUS_M
    heights: HeightRange = HEIGHTS_M
    as_of: When | None = None


class Export(Command[Document], frozen=True, tag="export"):
    """Export the map as a document, checked first; with `inferred` including inferred facts.

    With `as_of` the map as it was then; what followed and was measured then is worked out again.
    """

    format: RdfFormat = "rdfxml"
    inferred: bool = False
    as_of: When | None = None


class Classes(Command[tuple[ClassInfo, ...]], frozen=True, tag="classes"):
    """The classes of the TBox, with the number of entities of each."""


class Properties(Command[tuple[PropertyInfo, ...]], frozen=True, tag="properties"):
    """The data and object properties of the TBox that may be `set`: what they take, and their labels."""


class Status(Command[SystemStatus], frozen=True, tag="status"):
    """The state of the nodes, the map and the scene, and any problems.

    With `names`, `in_agreement`, `pending` and `displaced` concern these entities only, whatever others do.
    """

    names: tuple[Word, ...] = ()


# To ask about the past, and to take back


class History(Command[tuple[LoggedCommit, ...]], frozen=True, tag="history"):
    """The newest commits, or those that touched an entity, in order; `since` and `until` are included."""

    name: Word | None = None
    since: When | None = None
    until: When | None = None
    limit: Annotated[int, Meta(ge=1, le=10_000)] = 100


class LastSeen(Command[Sighting], frozen=True, tag="last-seen"):
    """When, where and by whom an entity was last seen or placed, even if it has been removed.

    The answer tells what has merely not been seen since from what was seen to be gone.
    """

    name: Word


class Undo(Command[Changed], frozen=True, tag="undo"):
    """Undo a commit by a new one, unless later ones depend on it; the scene follows.

    Without `commit`: the newest that a client asked for, with the settling that followed it. While a `move`,
    `open`, `close` or `drive` has yet to be committed, that is stopped instead, and no commit is undone.
    """

    commit: Annotated[int, Meta(ge=1, le=1 << 53)] | None = None
    dry_run: bool = False


# To let agents change


class Submit(Command[Request], frozen=True, tag="submit"):
    """Ask a person to approve a change, in words; under the same `id`, ask what became of it.

    `text` says what is to be done, `follows` what would follow from it, a line each. Approval is no lock: who
    submits a change makes it when it is approved.
    """

    text: Annotated[str, Meta(min_length=1, max_length=2000)]
    follows: Annotated[Told, Meta(max_length=200)] = ()


class Approve(Command[tuple[Request, ...]], frozen=True, tag="approve"):
    """The requests of agents that wait; with a `number` that one is approved or, with `reject`, rejected.

    `reject` with `all` rejects all that wait.
    """

    number: Annotated[int, Meta(ge=1, le=1 << 53)] | None = None
    reject: bool = False
    all: bool = False


# To keep


class Backup(Command[BackupPart], frozen=True, tag="backup"):
    """A part of a backup of the map with its history: the first, or the one `at` what a part names as `next`.

    All parts one after another, while the map goes on, are the file as of the first: `schemas/backups.py`.
    """

    at: str = ""


class Compact(Command[Compacted], frozen=True, tag="compact"):
    """Let a snapshot take the place of the commits that are older than `keep`: `12h` or `30d`.

    The history begins there from then on: nothing before it can be asked about or undone. With `dry_run`
    nothing is done; the reply says what would be.
    """

    keep: str = "30d"
    dry_run: bool = False


# To query


QueryText = Annotated[str, Meta(min_length=1, max_length=100_000)]
RowLimit = Annotated[int, Meta(ge=1, le=100_000)]
TimeLimit = Annotated[float, Meta(gt=0.0, le=60.0)]


class Sparql(Command[SparqlResult], frozen=True, tag="sparql"):
    """A SPARQL 1.1 query over asserted or, with `inferred`, also inferred facts; with `as_of` those of then.

    It only reads. It is refused when it takes longer than `timeout` [s] or has more than `limit` rows.
    """

    query: QueryText
    inferred: bool = False
    as_of: When | None = None
    timeout: TimeLimit = 5.0
    limit: RowLimit = 10_000


class Watch(Command[Watching], frozen=True, tag="watch"):
    """A standing question: its current rows, and their changes on `semmap/jena/query/<watch>`.

    A SELECT; or, instead of a `query`, who is `on`, `in` or `near` something (`within` so many metres), as
    for `List`: then a row is an entity's IRI.

    `watch` names it (without one a name is made): whoever follows the key first misses nothing. It is
    evaluated again when a commit may touch it, and ends `lease` seconds after the last `renew`.
    """

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
        """What it asks of where things are, if it does."""
        where = Where(on=self.on, in_=self.in_, near=self.near, within=self.within)
        return None if where == Where() else where


class Renew(Command[Done], frozen=True, tag="renew"):
    """Renew the lease of a standing query or, with `end`, end it."""

    watch: Name
    end: bool = False


# To run


class Move(Command[Moved], frozen=True, tag="move"):
    """Move the body of an entity by hand; the map follows when it comes to rest.

    With `carry`, the bodies of what stands on it or is inside it (as the map has it) are moved with it as one
    rigid body, and the map follows all of them in one commit; not those that `leave` names. `frame` is as for
    `add`. `wait` delays the reply until the commit exists, or it is clear that there is none; while time is
    paused, nothing is waited for.
    """

    name: Word
    at: Vector
    yaw: Angle | None = None
    frame: FrameName | None = None
    carry: bool = False
    leave: tuple[Word, ...] = ()
    wait: bool = False


class Open(Command[Moved], frozen=True, tag="open"):
    """Open a thing as a hand would: its joints move `to` this share of their way; the map follows at rest.

    With a `joint`, only that one of several. Refused for what has no joints; NoAnswer without a simulator.
    `wait` delays the reply until it stands and the map has followed, as for `move`. What is in the way stops
    it.
    """

    name: Word
    to: Probability = 1.0
    joint: Word | None = None
    wait: bool = False


class Close(Command[Moved], frozen=True, tag="close"):
    """Close a thing as a hand would; as for `open`."""

    name: Word
    joint: Word | None = None
    wait: bool = False


class Drive(Command[Moved], frozen=True, tag="drive"):
    """Drive a robot of the simulator to a point, or through several, in a straight line to each.

    At the end it faces `yaw`. Points and `yaw` are in the map frame, or in `frame` as that is when the
    command begins. It turns to where it goes first, and goes at most at `speed` [m/s]. With `stop` it stops
    where it is. `wait` delays the reply until it is there and the map has followed, as for `move`; where it
    gets no further, or falls, that is Refused.
    """

    name: Word
    to: tuple[Point, ...] = ()
    yaw: Angle | None = None
    frame: FrameName | None = None
    speed: Annotated[float, Meta(gt=0.0, le=2.0)] = 0.4
    stop: bool = False
    wait: bool = False


class Learn(Command[LessonTold], frozen=True, tag="learn"):
    """Show perception a thing of a class: what it sees of an `entity` now, or `views` of it.

    It is recognised from then on; the class may be new to perception, but the TBox must have it. `shown` says
    where the views are from.
    """

    class_: ClassName = field(name="class")
    entity: Word | None = None
    views: Annotated[tuple[ShownView, ...], Meta(max_length=200)] = ()
    shown: Remark = ""


class Learned(Command[tuple[LessonTold, ...]], frozen=True, tag="learned"):
    """What perception was shown, in order."""


class Forget(Command[LessonTold], frozen=True, tag="forget"):
    """Undo a lesson of perception's."""

    number: Annotated[int, Meta(ge=1)]


class Pause(Command[Done], frozen=True, tag="pause"):
    """Pause simulated time, or with `off` resume it."""

    off: bool = False


class StepOnce(Command[Done], frozen=True, tag="step"):
    """Advance paused time by `seconds`; refused while time is running."""

    seconds: Annotated[float, Meta(gt=0.0, le=60.0)] = 0.1


class Reset(Command[Done], frozen=True, tag="reset"):
    """Put every body where the map says it stands."""


class TakePicture(Command[Picture], frozen=True, tag="picture"):
    """A picture of the scene, from one of the world's cameras or from above; or of one `place`.

    With `labels` the names of the entities are written on it.
    """

    camera: Word | None = None
    place: Word | None = None
    labels: bool = False
    width: Annotated[int, Meta(ge=16, le=4096)] = 960
    height: Annotated[int, Meta(ge=16, le=4096)] = 720


COMMANDS: dict[str, type[Command]] = {str(c.__struct_config__.tag): c for c in Command.__subclasses__()}
"""Verb to request type."""

for _verb, _command in COMMANDS.items():
    _command.VERB = _verb
