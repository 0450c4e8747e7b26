"""Replies to commands; each command names its reply type (`semmap.schemas.commands`)."""

from __future__ import annotations

from typing import Any, Literal

from msgspec import Struct

from semmap.schemas.changes import Change
from semmap.schemas.entities import Pose, Probability, Provenance, Source
from semmap.schemas.errors import ErrorMessage
from semmap.schemas.explanations import Explanation, Triple
from semmap.schemas.relations import Relation


class Changed(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The map has changed (or, without `commit`, there was nothing to change)."""

    commit: int | None
    text: str
    names: tuple[str, ...] = ()
    skipped: tuple[str, ...] = ()
    """What was left out, and why."""
    notes: tuple[str, ...] = ()
    """How the request was understood, where it was not taken literally; and what may be a mistake."""
    dry_run: bool = False
    """Nothing was done: this is what would have been."""
    follows: tuple[str, ...] = ()
    """Of a dry run: what would follow about the entities that it touches, and does not now."""
    no_longer_follows: tuple[str, ...] = ()
    undone: tuple[Change, ...] = ()
    """Of an undo: what the commits that it took back had changed, of the first entities that they touched."""


class Checked(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The verdict."""

    consistent: bool
    engine: str
    triples: int
    elapsed_s: float
    text: str
    explanation: Explanation | None = None
    denied: tuple[Relation, ...] = ()
    """What somebody said of where things are, and is not so as they stand; it contradicts nothing."""
    withheld: tuple[str, ...] = ()
    """What is measured of where things are and would contradict the map, with the reason, a sentence each."""
    crowds: tuple[str, ...] = ()
    """Where so many things are in one spot that not all are looked at as bearers, a sentence each."""


class Compacted(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How many commits a snapshot has taken the place of (or would, in a dry run), and what remains."""

    commits: int
    first: int
    """The first commit that is kept."""
    bytes_before: int
    """What the journal takes on disk."""
    bytes_after: int
    text: str
    dry_run: bool = False


class Possible(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Whether something could be without contradicting the map."""

    possible: bool
    text: str
    """The answer in one sentence; if it could not be, why not."""
    explanation: Explanation | None = None
    """Why it could not be."""


class Inferred(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Triples that follow, grouped by subject in the order of names."""

    triples: tuple[Triple, ...]
    text: tuple[str, ...]
    """One line a triple, with local names."""


class Document(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A serialised map, as it was after commit `seq`."""

    content: bytes
    media_type: str
    triples: int
    seq: int


class NodeStatus(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One node, as its heartbeats tell."""

    node: str
    state: Literal["starting", "ready", "silent"]
    host: str = ""
    """The name of the machine that it runs on."""
    pid: int
    uptime_s: float
    heartbeat_age_s: float
    detail: str = ""
    last_error: str = ""
    notes: tuple[str, ...] = ()
    """What is good to know of what it works with: of the knowledge base, on its TBox."""


class SystemStatus(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The whole system. `version` is that of semmap in the coordinator."""

    truth: str
    commit: int
    entities: int
    bodies: int
    in_agreement: bool | None
    """Map and scene are the same, to within the thresholds, and nothing is `pending` or `displaced`.

    None when no simulator runs, and when the map is updated by perception only. It is false while a robot
    drives, so a program that waits names the entities that it waits for (`names` of the command).
    """
    nodes: tuple[NodeStatus, ...]
    problems: tuple[str, ...] = ()
    version: str = ""
    pending: tuple[str, ...] = ()
    """Changes of the scene or the map that are still to be made, a sentence each.

    These are the first five, and how many more there are. Empty when every entity has its body and the map
    follows all that rests."""
    displaced: tuple[str, ...] = ()
    """Bodies that move or stand farther from their committed pose than the thresholds, in the same form:
    `robot1 is moving: 1.2 m from its committed pose`."""


class LoggedCommit(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A commit without its triples: who, when, why, how sure, and what it touched."""

    seq: int
    stamp_ns: int
    source: Source
    agent: str
    verb: str
    reason: str
    confidence: Probability | None
    undoes: tuple[int, ...]
    tbox: bool
    inserted: int
    """How many triples came."""
    retracted: int
    """How many went."""
    changed: tuple[str, ...]
    removed: tuple[str, ...]
    changes: tuple[Change, ...] = ()
    """What was and what is, of the first entities that it touched."""
    notes: tuple[str, ...] = ()
    """What else there is to know of it: see `semmap.schemas.commits.Commit`."""
    authenticated: bool = False
    """A certificate has proved the agent's name; else it is as somebody said."""


class Sighting(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Where an entity was last, and by whose word; and whether it is known to be gone from there.

    `removed` is the commit that took it out of the map since. `gone` is the commit by which perception said
    that the place was looked at and the entity was not there; None where nobody has seen that. `seen_ns` is
    when a camera last saw it [ns since 1970], as long as the knowledge base has been running; None if none
    has. `text` says all this in one sentence.
    """

    name: str
    pose: Pose | None
    provenance: Provenance
    removed: Provenance | None
    gone: Provenance | None = None
    seen_ns: int | None = None
    text: str = ""


class Moved(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The body was moved: the map follows when it comes to rest, by `commit` if that was waited for.

    Without a `commit`, `notes` say why there is none (yet): nobody waited, time is paused, or the map has the
    body there already.
    """

    name: str
    text: str
    commit: int | None = None
    notes: tuple[str, ...] = ()


class Done(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """It was done."""

    text: str


class Ack(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The answer to a command that came as a put."""

    id: str
    verb: str
    ok: bool
    reply: Any = None
    error: ErrorMessage | None = None
