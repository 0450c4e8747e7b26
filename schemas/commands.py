"""What one may ask: one verb, one Struct, one reply.

The fields are the words of the command line (`semmap add Chair --at 1 2 0`), of a selector
(`semmap/cmd/add?class=Chair;at=1,2,0`) and of a message (`{"verb": "add", "class": "Chair", ...}`)
alike. Positions and sizes are metres in the map frame, angles are radians.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from msgspec import Meta, Struct, field

from schemas.entities import (
    Angle,
    ClassInfo,
    Entity,
    Name,
    Probability,
    Quaternion,
    Size,
    Source,
    Text,
    Vector,
)
from schemas.explanations import Explanation, Triple
from schemas.scenes import Picture
from schemas.sparql import SparqlResult, Watching

RDF_FORMATS = ("rdfxml", "turtle", "ntriples", "jsonld")
RdfFormat = Literal["rdfxml", "turtle", "ntriples", "jsonld"]
ListFormat = Literal["json", "lu4r", "legacy"]
ClassName = Annotated[str, Meta(min_length=1, max_length=200)]


class Command(
    Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="verb", omit_defaults=True
):
    """What every command has.

    The same `id` sent twice is executed once, and answered twice with the same result.
    """

    id: str = ""
    source: Source = "operator"
    agent: str = ""
    reason: str = ""


# To change


class Add(Command, frozen=True, kw_only=True, tag="add"):
    """Put an entity into the map.

    Without `name` one is made from the class; without `at` it goes to the next free place near the default
    pose; with `default` it also gets the class's label as reference. `wait` delays the reply until
    its body stands in the scene.
    """

    class_: ClassName = field(name="class")
    name: Name | None = None
    at: Vector | None = None
    yaw: Angle | None = None
    orientation: Quaternion | None = None
    size: Size | None = None
    ref: Text | None = None
    alt: tuple[Text, ...] = ()
    confidence: Probability | None = None
    default: bool = False
    wait: bool = False


class Update(Command, frozen=True, kw_only=True, tag="update"):
    """Change what is named; what is not named stays. `alt` replaces all alternative references."""

    name: str
    class_: ClassName | None = field(name="class", default=None)
    at: Vector | None = None
    yaw: Angle | None = None
    orientation: Quaternion | None = None
    size: Size | None = None
    ref: Text | None = None
    alt: tuple[Text, ...] | None = None
    confidence: Probability | None = None
    wait: bool = False


class Remove(Command, frozen=True, kw_only=True, tag="remove"):
    """Take entities out of the map and the scene: all of them, or, if one is unknown, none."""

    names: tuple[str, ...]


class Clear(Command, frozen=True, kw_only=True, tag="clear"):
    """Take every entity out of the map and the scene. The TBox stays."""


class Load(Command, frozen=True, kw_only=True, tag="load"):
    """Add what a file describes: an ABox, a scene in JSON or a HuRIC map, told apart by content.

    `replace` takes the present entities out in the same commit. `skip_unknown` leaves out what is of a
    class that the TBox does not have; without it, one such refuses the whole file.
    """

    content: bytes
    filename: str = ""
    replace: bool = False
    skip_unknown: bool = False


class Changed(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The map has changed (or, without `commit`, there was nothing to change)."""

    commit: int | None
    text: str
    names: tuple[str, ...] = ()
    skipped: tuple[str, ...] = ()
    """What was left out, and why."""
    notes: tuple[str, ...] = ()
    """How the request was understood, where it was not taken literally."""


# To ask


class List(Command, frozen=True, kw_only=True, tag="list"):
    """The entities of a class (all, without one), over inferred types."""

    class_: ClassName | None = field(name="class", default=None)
    format: ListFormat = "json"


class Get(Command, frozen=True, kw_only=True, tag="get"):
    """One entity."""

    name: str


class Check(Command, frozen=True, kw_only=True, tag="check"):
    """Is the map consistent, and if not, why? `owlrl` is the slow second opinion."""

    engine: Literal["semmap", "owlrl"] = "semmap"


class Checked(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The verdict."""

    consistent: bool
    engine: str
    triples: int
    elapsed_s: float
    text: str
    explanation: Explanation | None = None


class Infer(Command, frozen=True, kw_only=True, tag="infer"):
    """What follows that was not said, about one individual or about all entities."""

    name: str | None = None


class Inferred(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Triples that follow, grouped by subject in the order of names."""

    triples: tuple[Triple, ...]
    text: tuple[str, ...]
    """One line a triple, with local names."""


class Explain(Command, frozen=True, kw_only=True, tag="explain"):
    """Why a triple holds: `name`, `predicate` and `value` are local names, IRIs in <> or literals."""

    name: str
    predicate: str
    value: str


class Export(Command, frozen=True, kw_only=True, tag="export"):
    """The map as a document, checked first; with `inferred` also what follows from it."""

    format: RdfFormat = "rdfxml"
    inferred: bool = False


class Document(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A serialised map, as it was after commit `seq`."""

    content: bytes
    media_type: str
    triples: int
    seq: int


class Classes(Command, frozen=True, kw_only=True, tag="classes"):
    """The classes of the TBox, with the number of entities of each."""


class Status(Command, frozen=True, kw_only=True, tag="status"):
    """The nodes and the map: who runs, since when, and what is amiss."""


class NodeStatus(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One node, as its heartbeats tell."""

    node: str
    state: Literal["starting", "ready", "silent"]
    pid: int
    uptime_s: float
    heartbeat_age_s: float
    detail: str = ""
    last_error: str = ""


class SystemStatus(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The whole system."""

    truth: str
    commit: int
    entities: int
    bodies: int
    in_agreement: bool | None
    """Map and scene are the same, to within the thresholds; None when no simulator runs."""
    nodes: tuple[NodeStatus, ...]
    problems: tuple[str, ...] = ()


# To query


QueryText = Annotated[str, Meta(min_length=1, max_length=100_000)]
RowLimit = Annotated[int, Meta(ge=1, le=100_000)]
TimeLimit = Annotated[float, Meta(gt=0.0, le=60.0)]


class Sparql(Command, frozen=True, kw_only=True, tag="sparql"):
    """A SPARQL 1.1 query over what is asserted or, with `inferred`, also over what follows from it.

    It only reads. It is refused when it takes longer than `timeout` [s] or has more than `limit` rows.
    """

    query: QueryText
    inferred: bool = False
    timeout: TimeLimit = 5.0
    limit: RowLimit = 10_000


class Watch(Command, frozen=True, kw_only=True, tag="watch"):
    """A standing SELECT: its rows now, and what changes of them on `semmap/jena/query/<watch>`.

    `watch` names it (without one a name is made): whoever follows the key first misses nothing. It is
    evaluated again when a commit may touch it, and ends `lease` seconds after the last `renew`.
    """

    query: QueryText
    inferred: bool = False
    watch: Name | None = None
    lease: Annotated[float, Meta(ge=1.0, le=3600.0)] = 30.0


class Renew(Command, frozen=True, kw_only=True, tag="renew"):
    """Keep a standing query for another lease or, with `end`, end it."""

    watch: Name
    end: bool = False


# To run


class Move(Command, frozen=True, kw_only=True, tag="move"):
    """Take the body of an entity and put it elsewhere, as a hand would: the map follows when it rests."""

    name: str
    at: Vector
    yaw: Angle | None = None


class Moved(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The body was taken and released."""

    name: str
    text: str


class Pause(Command, frozen=True, kw_only=True, tag="pause"):
    """Stop simulated time; a second time: let it run again."""


class StepOnce(Command, frozen=True, kw_only=True, tag="step"):
    """Let paused time go on by `seconds`."""

    seconds: Annotated[float, Meta(gt=0.0, le=60.0)] = 0.1


class Reset(Command, frozen=True, kw_only=True, tag="reset"):
    """Put every body back where the map says it stands."""


class TakePicture(Command, frozen=True, kw_only=True, tag="picture"):
    """A picture of the scene, from one of the world's cameras or from above."""

    camera: str | None = None
    width: Annotated[int, Meta(ge=16, le=4096)] = 960
    height: Annotated[int, Meta(ge=16, le=4096)] = 720


class Done(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """It was done."""

    text: str


REPLIES: dict[type[Command], Any] = {
    Add: Changed,
    Update: Changed,
    Remove: Changed,
    Clear: Changed,
    Load: Changed,
    List: Any,  # Entity messages, or the document of the wanted format
    Get: Entity,
    Check: Checked,
    Infer: Inferred,
    Explain: Explanation,
    Export: Document,
    Classes: tuple[ClassInfo, ...],
    Status: SystemStatus,
    Move: Moved,
    Pause: Done,
    StepOnce: Done,
    Reset: Done,
    TakePicture: Picture,
    Sparql: SparqlResult,
    Watch: Watching,
    Renew: Done,
}

COMMANDS: dict[str, type[Command]] = {str(c.__struct_config__.tag): c for c in REPLIES}
"""Verb to request type."""


class Ack(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The answer to a command that came as a put."""

    id: str
    verb: str
    ok: bool
    reply: Any = None
    error: Any = None
