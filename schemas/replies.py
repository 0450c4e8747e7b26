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
    """The result of a change; without a `commit`, nothing had to be changed."""

    commit: int | None
    text: str
    names: tuple[str, ...] = ()
    skipped: tuple[str, ...] = ()
    """Skipped items, with the reason."""
    notes: tuple[str, ...] = ()
    """How the request was interpreted, and possible mistakes in it."""
    dry_run: bool = False
    """Whether it was a dry run: nothing was changed."""
    follows: tuple[str, ...] = ()
    """In a dry run: new inferences about the affected entities."""
    no_longer_follows: tuple[str, ...] = ()
    undone: tuple[Change, ...] = ()
    """For undo: the changes of the undone commits, for the first affected entities."""


class Violation(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A fact that violates a SHACL shape."""

    name: str
    """The entity, or the individual, class or value that the shape is about."""
    message: str
    """The message of the shape, or the constraint that is violated."""
    path: str = ""
    """The property, or the property path, that leads to the value."""
    value: str = ""
    severity: Literal["violation", "warning", "info"] = "violation"
    shape: str = ""
    """The name of the shape; empty if it has none."""
    text: str
    """The violation in one line: the name, the message, the path and the value."""


class Checked(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The result of a consistency check."""

    consistent: bool
    engine: str
    triples: int
    elapsed_s: float
    text: str
    explanation: Explanation | None = None
    denied: tuple[Relation, ...] = ()
    """Asserted spatial relations that the geometry contradicts; they do not make the map inconsistent."""
    withheld: tuple[str, ...] = ()
    """Computed spatial relations that are suppressed as they would contradict the map, with the reason."""
    crowds: tuple[str, ...] = ()
    """Spots with so many things that not all are considered as supports, one sentence each."""
    conforms: bool | None = True
    """Whether no SHACL shape is violated; None if shapes were not evaluated and the others are not violated.
    """
    shapes: int = 0
    """The number of SHACL shapes with a target that the facts were compared with."""
    violation_count: int = 0
    """The number of violations, of which `violations` has the first 1000."""
    violations: tuple[Violation, ...] = ()
    notes: tuple[str, ...] = ()
    """What of the shapes was not evaluated."""


class Compacted(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The number of commits that a snapshot replaced (or would, in a dry run), and what remains."""

    commits: int
    first: int
    """The first commit that is kept."""
    bytes_before: int
    """The size of the journal on disk."""
    bytes_after: int
    text: str
    dry_run: bool = False


class Possible(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Whether a statement would be consistent with the map."""

    possible: bool
    text: str
    """The answer in one sentence, with the reason if it is not possible."""
    explanation: Explanation | None = None
    """The proof that it is not possible."""


class Inferred(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Inferred triples, grouped by subject and sorted by name."""

    triples: tuple[Triple, ...]
    text: tuple[str, ...]
    """One line per triple, with local names."""


class Document(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A serialised map after commit `seq`."""

    content: bytes
    media_type: str
    triples: int
    seq: int
    notes: tuple[str, ...] = ()
    """Notes on triples that the format cannot express."""


class NodeStatus(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The state of a node according to its heartbeats."""

    node: str
    state: Literal["starting", "ready", "silent"]
    host: str = ""
    """The name of its machine."""
    pid: int
    uptime_s: float
    heartbeat_age_s: float
    detail: str = ""
    last_error: str = ""
    notes: tuple[str, ...] = ()
    """Notes about its data, such as the knowledge base's TBox."""


class SystemStatus(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The state of the whole system. `version` is the coordinator's version of semmap."""

    truth: str
    commit: int
    entities: int
    bodies: int
    in_agreement: bool | None
    """Whether map and scene agree within the thresholds, and nothing is `pending` or `displaced`.

    It is None without a simulator, and if only perception updates the map. It is false while a robot drives,
    so a program that waits should give the entities that it waits for (`names` of the command).
    """
    nodes: tuple[NodeStatus, ...]
    problems: tuple[str, ...] = ()
    version: str = ""
    pending: tuple[str, ...] = ()
    """Pending changes of the scene or the map, one sentence each.

    Only the first five are listed, with the number of the others. Empty if every entity has its body, and the
    poses of all bodies at rest are committed."""
    displaced: tuple[str, ...] = ()
    """Bodies that are moving, or farther from their committed pose than the thresholds, in the same form:
    `robot1 is moving: 1.2 m from its committed pose`."""


class LoggedCommit(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A commit without its triples: author, time, reason, confidence and affected entities."""

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
    """The number of inserted triples."""
    retracted: int
    """The number of retracted triples."""
    changed: tuple[str, ...]
    removed: tuple[str, ...]
    changes: tuple[Change, ...] = ()
    """The previous and new values for the first affected entities."""
    notes: tuple[str, ...] = ()
    """Notes about the commit: see `semmap.schemas.commits.Commit`."""
    authenticated: bool = False
    """Whether the agent's name was authenticated by a certificate."""


class Sighting(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The last pose of an entity, and whether the entity was observed to be absent.

    `pose` is the live pose, or the last stored one if that is newer than the committed pose; otherwise it is
    the committed pose, which has the `provenance`. `removed` is the commit that removed it from the map.
    `gone` is the commit in which perception reported that the place was observed and the entity absent; None
    if there is none. `seen_ns` is the time of the live pose, or of the last observation by a camera since the
    knowledge base was started [ns since 1970]; None if there is neither. `text` is a summary in one sentence.
    """

    name: str
    pose: Pose | None
    provenance: Provenance
    removed: Provenance | None
    gone: Provenance | None = None
    seen_ns: int | None = None
    text: str = ""


class Moved(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The body was moved; its pose is committed when it comes to rest, in `commit` if that was waited for.

    Without a `commit`, `notes` give the reason: the command did not wait, time is paused, or the map already
    has this pose.
    """

    name: str
    text: str
    commit: int | None = None
    notes: tuple[str, ...] = ()

    @property
    def is_final(self) -> bool:
        """Whether the map follows no more: there is a commit, or a note why there will be none."""
        return self.commit is not None or any(note.startswith("no commit: ") for note in self.notes)


class Done(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The command succeeded."""

    text: str


class Ack(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The reply to a command that was sent as a put."""

    id: str
    verb: str
    ok: bool
    reply: Any = None
    error: ErrorMessage | None = None
