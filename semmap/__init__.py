"""semmap: a robot's semantic map, as a library.

    import semmap

    with semmap.connect() as client:
        client.add("Cup", "cup1", at=(1.0, 2.0, 0.75), ref="coffee cup")
        for entity in client.list("Graspable_Thing"):
            print(entity.name, entity.pose)

Further modules:

- `semmap.aio`: the same client for an event loop
- `semmap.fleet`: queries to several robots
- `semmap.recordings`: videos and replays of the history
- `semmap.testing`: a system for your tests
- `semmap.reasoner`: the OWL 2 RL reasoner as a library
- `semmap.commands`: the commands as messages
- `semmap.wire`: keys and messages for programs that use Zenoh directly

Only the names in `__all__` of these modules are public. `semmap.nodes`, `semmap.schemas` and
`semmap.ontology` are private and can change with any version.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from semmap import aio, commands, fleet, reasoner, recordings, testing, wire
    from semmap.nodes.extern.backup import restore
    from semmap.nodes.extern.client import Client, connect
    from semmap.nodes.extern.sparql_client import StandingQuery
    from semmap.ontology.vocabulary import local_name
    from semmap.schemas.approvals import Request
    from semmap.schemas.backups import BackupPart, Opening, Restored
    from semmap.schemas.changes import Change
    from semmap.schemas.commits import Commit, Departed, Extent, PlaceChanges
    from semmap.schemas.entities import (
        BodyState,
        ClassInfo,
        Entity,
        Live,
        Pose,
        PropertyInfo,
        Provenance,
        RuleInfo,
    )
    from semmap.schemas.episodes import Episode, PastAnswer
    from semmap.schemas.errors import (
        BadFile,
        BadRequest,
        Busy,
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
    from semmap.schemas.exemplars import LessonTold, ShownView
    from semmap.schemas.explanations import Explanation, Step
    from semmap.schemas.frames import Frame
    from semmap.schemas.joints import Joint
    from semmap.schemas.language import (
        Account,
        Antecedent,
        Argument,
        Candidate,
        CommandStep,
        Filler,
        Found,
        Grounded,
        PlaceRelation,
        SemanticFrame,
        ThingDescription,
        Understood,
    )
    from semmap.schemas.map_history import Difference, Related, Spell, Spells, Trail, TrailPoint, Visit
    from semmap.schemas.plans import Outline, Plan, PlannedPlace, PlannedThing, Way
    from semmap.schemas.relations import Described, Relation
    from semmap.schemas.replies import (
        Changed,
        Checked,
        Compacted,
        Document,
        Done,
        Inferred,
        LoggedCommit,
        Moved,
        NodeStatus,
        Possible,
        Sighting,
        SystemStatus,
        Violation,
    )
    from semmap.schemas.scenes import Picture
    from semmap.schemas.sparql import RowsChanged, SparqlResult, Watching

__all__ = [
    "Account",
    "Antecedent",
    "Argument",
    "BackupPart",
    "BadFile",
    "BadRequest",
    "BodyState",
    "Busy",
    "Candidate",
    "Change",
    "Changed",
    "Checked",
    "ClassInfo",
    "Client",
    "CommandStep",
    "Commit",
    "Compacted",
    "Departed",
    "Described",
    "Difference",
    "Document",
    "Done",
    "Entity",
    "Episode",
    "Explanation",
    "Extent",
    "Filler",
    "Found",
    "Frame",
    "Grounded",
    "Inconsistent",
    "Inferred",
    "InternalError",
    "Joint",
    "LessonTold",
    "Live",
    "LoggedCommit",
    "Moved",
    "NameTaken",
    "NoAnswer",
    "NodeStatus",
    "Opening",
    "Outline",
    "PastAnswer",
    "Picture",
    "PlaceChanges",
    "PlaceRelation",
    "Plan",
    "PlannedPlace",
    "PlannedThing",
    "Pose",
    "Possible",
    "PreconditionFailed",
    "PropertyInfo",
    "Provenance",
    "Refused",
    "Related",
    "Relation",
    "Request",
    "Restored",
    "RowsChanged",
    "RuleInfo",
    "SemanticFrame",
    "SemmapError",
    "ShownView",
    "Sighting",
    "SparqlResult",
    "Spell",
    "Spells",
    "StandingQuery",
    "Step",
    "SystemStatus",
    "ThingDescription",
    "Trail",
    "TrailPoint",
    "Understood",
    "UnknownClass",
    "UnknownName",
    "UnknownVerb",
    "Violation",
    "Visit",
    "Watching",
    "Way",
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

_MODULES: Final = frozenset({"aio", "commands", "fleet", "reasoner", "recordings", "testing", "wire"})
_NAMES_OF: Final = {
    "nodes.extern.backup": ("restore",),
    "nodes.extern.client": (
        "Client",
        "connect",
    ),
    "nodes.extern.sparql_client": ("StandingQuery",),
    "ontology.vocabulary": ("local_name",),
    "schemas.approvals": ("Request",),
    "schemas.backups": (
        "BackupPart",
        "Opening",
        "Restored",
    ),
    "schemas.changes": ("Change",),
    "schemas.commits": (
        "Commit",
        "Departed",
        "Extent",
        "PlaceChanges",
    ),
    "schemas.entities": (
        "BodyState",
        "ClassInfo",
        "Entity",
        "Live",
        "Pose",
        "PropertyInfo",
        "Provenance",
        "RuleInfo",
    ),
    "schemas.errors": (
        "BadFile",
        "BadRequest",
        "Busy",
        "Inconsistent",
        "InternalError",
        "NameTaken",
        "NoAnswer",
        "PreconditionFailed",
        "Refused",
        "SemmapError",
        "UnknownClass",
        "UnknownName",
        "UnknownVerb",
    ),
    "schemas.explanations": (
        "Explanation",
        "Step",
    ),
    "schemas.episodes": ("Episode", "PastAnswer"),
    "schemas.frames": ("Frame",),
    "schemas.map_history": (
        "Difference",
        "Related",
        "Spell",
        "Spells",
        "Trail",
        "TrailPoint",
        "Visit",
    ),
    "schemas.joints": ("Joint",),
    "schemas.language": (
        "Account",
        "Antecedent",
        "CommandStep",
        "Filler",
        "PlaceRelation",
        "ThingDescription",
        "Argument",
        "Candidate",
        "Found",
        "Grounded",
        "SemanticFrame",
        "Understood",
    ),
    "schemas.exemplars": (
        "ShownView",
        "LessonTold",
    ),
    "schemas.plans": (
        "Outline",
        "Plan",
        "PlannedPlace",
        "PlannedThing",
        "Way",
    ),
    "schemas.relations": (
        "Described",
        "Relation",
    ),
    "schemas.replies": (
        "Changed",
        "Checked",
        "Compacted",
        "Document",
        "Done",
        "Inferred",
        "LoggedCommit",
        "Moved",
        "NodeStatus",
        "Possible",
        "Sighting",
        "SystemStatus",
        "Violation",
    ),
    "schemas.scenes": ("Picture",),
    "schemas.sparql": (
        "Watching",
        "RowsChanged",
        "SparqlResult",
    ),
}
_MODULE_OF: Final = {name: module for module, names in _NAMES_OF.items() for name in names}


def __getattr__(name: str) -> Any:
    """Import a public name or module on first use.

    Every submodule imports this module first, so it must not import anything: `semmap.schemas` is pure data,
    `semmap.reasoner` needs no Zenoh, and a node does not load the client.
    """
    if name in _MODULES:
        return importlib.import_module(f"semmap.{name}")
    if name == "__version__":
        from importlib.metadata import version

        return version("semmap")
    if name not in _MODULE_OF:
        raise AttributeError(f"module 'semmap' has no attribute '{name}'")
    value = globals()[name] = getattr(importlib.import_module(f"semmap.{_MODULE_OF[name]}"), name)
    return value


def __dir__() -> list[str]:
    """Return the public names, also those that have not been imported yet."""
    return sorted({*globals(), *__all__})
