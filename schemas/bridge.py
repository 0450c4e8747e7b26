"""What the coordinator asks of the knowledge base, besides `commit` (schemas/commits.py)."""

from __future__ import annotations

from typing import Annotated, Any

from msgspec import Meta, Struct

from schemas.commands import (
    Check,
    Classes,
    Explain,
    Export,
    Get,
    History,
    Infer,
    LastSeen,
    List,
    Renew,
    Sparql,
    Undo,
    Watch,
)
from schemas.commits import Commit, Effects, Snapshot, Star, Transaction
from schemas.entities import ClassInfo, CommandId, Entity, Source
from schemas.errors import ErrorMessage
from schemas.explanations import Explanation
from schemas.replies import Checked, Document, Done, Inferred, LoggedCommit, Sighting
from schemas.sparql import SparqlResult, Watching


class SnapshotQuery(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The entities, with the number of the commit that they are true after.

    With a `limit`, a page of that many at most: those whose names come after `after`, in their order. Other
    commits may come between two pages; who follows those and takes them all in has the map in the end.
    """

    after: str = ""
    limit: Annotated[int, Meta(ge=1)] | None = None


class StarQuery(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The stars of these entities; UnknownName if one is not there."""

    names: tuple[str, ...]
    together: bool = True
    """What only they use counts as their own; if not, only what one of them uses alone is its own."""


class Recall(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """These commits again, for a follower that has missed them; those that there never were are left out."""

    seqs: Annotated[tuple[int, ...], Meta(max_length=100)]


class Transactions(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Several changes, each accepted or refused by itself in this order, and made durable together."""

    transactions: tuple[Transaction, ...]


class Outcome(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What became of one of several changes: an error, or else the commit (None when it changed nothing)."""

    commit: Effects | None = None
    error: ErrorMessage | None = None


class LoadDocument(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Add an ABox in any RDF syntax in one commit; with `replace` instead of the present one."""

    id: CommandId
    source: Source
    agent: str = ""
    reason: str = ""
    content: bytes
    filename: str
    replace: bool
    skip_unknown: bool


class LoadTBox(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Let the TBox of a document, in any RDF syntax, take the place of the present one."""

    id: CommandId
    source: Source
    agent: str = ""
    reason: str = ""
    content: bytes
    filename: str


class Loaded(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The commit, the names of the entities that it changed, and what was left out and why."""

    commit: Effects | None
    names: tuple[str, ...] = ()
    skipped: tuple[str, ...]
    notes: tuple[str, ...] = ()


BRIDGE: dict[str, tuple[type[Struct], Any]] = {
    "commit": (Transaction, Effects | None),
    "commits": (Transactions, tuple[Outcome, ...]),
    "load": (LoadDocument, Loaded),
    "snapshot": (SnapshotQuery, Snapshot),
    "recall": (Recall, tuple[Commit, ...]),
    "star": (StarQuery, tuple[Star, ...]),
    "classes": (Classes, tuple[ClassInfo, ...]),
    "list": (List, tuple[Entity, ...]),
    "get": (Get, Entity),
    "check": (Check, Checked),
    "infer": (Infer, Inferred),
    "explain": (Explain, Explanation),
    "export": (Export, Document),
    "history": (History, tuple[LoggedCommit, ...]),
    "last-seen": (LastSeen, Sighting),
    "undo": (Undo, Effects),
    "load-tbox": (LoadTBox, Loaded),
    "sparql": (Sparql, SparqlResult),
    "watch": (Watch, Watching),
    "renew": (Renew, Done),
}
"""Verb to request and reply: what `semmap/bridge/<verb>` takes and gives. What changes nothing gives None."""
