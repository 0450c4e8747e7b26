"""semmap: a robot's semantic map, as a library.

    import semmap

    with semmap.connect() as client:
        client.add("Cup", "cup1", at=(1.0, 2.0, 0.75), ref="coffee cup")
        for entity in client.list("Graspable_Thing"):
            print(entity.name, entity.pose)

`semmap.aio` has the same client for an event loop, `semmap.fleet` asks several robots together,
`semmap.recordings` films and replays the past, `semmap.testing` has a system for your tests,
`semmap.reasoner` the OWL 2 RL reasoner by itself, `semmap.commands` what can be sent, and `semmap.wire` what
programs need that speak Zenoh themselves. Only the names in `__all__` of these modules are public; `nodes`,
`schemas` and `ontology` are private, and may change with any version.
"""

from __future__ import annotations

import importlib
from types import ModuleType
from typing import TYPE_CHECKING

from semmap.nodes.extern.client import Client, connect
from semmap.nodes.extern.restoring import restore
from semmap.nodes.extern.sparql_client import StandingQuery
from semmap.ontology.vocabulary import local_name
from semmap.schemas.backups import Restored
from semmap.schemas.commits import Commit, Departed
from semmap.schemas.entities import BodyState, ClassInfo, Entity, Pose, Provenance
from semmap.schemas.errors import (
    BadFile,
    BadRequest,
    Inconsistent,
    InternalError,
    NameTaken,
    NoAnswer,
    PreconditionFailed,
    Refused,
    SemmapError,
    UnknownClass,
    UnknownName,
    UnknownVerb,
)
from semmap.schemas.explanations import Explanation
from semmap.schemas.replies import (
    Changed,
    Checked,
    Document,
    Done,
    Inferred,
    LoggedCommit,
    Moved,
    NodeStatus,
    Sighting,
    SystemStatus,
)
from semmap.schemas.sparql import RowsChanged, SparqlResult

if TYPE_CHECKING:
    from semmap import aio, commands, fleet, reasoner, recordings, testing, wire

__all__ = [
    "BadFile",
    "BadRequest",
    "BodyState",
    "Changed",
    "Checked",
    "ClassInfo",
    "Client",
    "Commit",
    "Departed",
    "Document",
    "Done",
    "Entity",
    "Explanation",
    "Inconsistent",
    "Inferred",
    "InternalError",
    "LoggedCommit",
    "Moved",
    "NameTaken",
    "NoAnswer",
    "NodeStatus",
    "Pose",
    "PreconditionFailed",
    "Provenance",
    "Refused",
    "Restored",
    "RowsChanged",
    "SemmapError",
    "Sighting",
    "SparqlResult",
    "StandingQuery",
    "SystemStatus",
    "UnknownClass",
    "UnknownName",
    "UnknownVerb",
    "aio",
    "commands",
    "connect",
    "fleet",
    "local_name",
    "reasoner",
    "recordings",
    "restore",
    "testing",
    "wire",
]

_MODULES = {"aio", "commands", "fleet", "reasoner", "recordings", "testing", "wire"}


def __getattr__(name: str) -> ModuleType | str:
    """The modules of this package, imported when they are first used; and `__version__`."""
    if name in _MODULES:
        return importlib.import_module(f"semmap.{name}")
    if name == "__version__":
        from importlib.metadata import version

        return version("semmap")
    raise AttributeError(f"module 'semmap' has no attribute '{name}'")
