"""Replies as tables, trees and cards for a terminal."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final

from rich.console import Console
from rich.table import Table
from rich.text import Text
from rich.tree import Tree

from semmap.nodes.extern.cli.output.lines import format_commit_changes
from semmap.nodes.extern.cli.output.printable import escaped
from semmap.nodes.extern.cli.output.tables import card, printable, table
from semmap.nodes.extern.phrasing import (
    author,
    english,
    labelled,
    moment,
    pose_cells,
    pose_text,
    provenance_text,
    size_text,
)
from semmap.schemas import wording
from semmap.schemas.attachments import holder_of
from semmap.schemas.changes import value_in_words
from semmap.schemas.commits import Commit
from semmap.schemas.entities import ClassInfo, Entity, Pose, PropertyInfo, RuleInfo, Value
from semmap.schemas.frames import Frame
from semmap.schemas.joints import in_words
from semmap.schemas.map_history import Visit
from semmap.schemas.relations import Described, Relation
from semmap.schemas.replies import LoggedCommit, Sighting, SystemStatus

_WIDE = 100_000
_LEVEL = 1e-3
"""A quaternion with smaller x and y is a rotation about the z axis."""
_MOST_PROBLEMS: Final = 20
ENTITY_COLUMNS: Final = ("name", "class", "x", "y", "z", "yaw", "size", "label", "body")
_NUMBERS: Final = ("x", "y", "z", "yaw")
_HEADERS: Final = {"yaw": "yaw°", "size": "size [m]"}
_FOLDED = ("class", "size [m]", "label")


def console(piped_width: int = _WIDE) -> Console:
    """Return a console that does not shrink tables if the output is a file or a pipe.

    `piped_width` is the width in that case; longer lines are wrapped.
    """
    out = Console(highlight=False, soft_wrap=True, markup=False)
    if out.is_terminal:
        return out
    return Console(highlight=False, soft_wrap=True, markup=False, width=piped_width)


def entity_table(entities: Iterable[Entity], columns: Sequence[str] = ENTITY_COLUMNS) -> Table:
    """Return a table with one row per entity. `columns` are some of `ENTITY_COLUMNS`."""
    rows = table(*(_HEADERS.get(name, name) for name in columns), fold=_FOLDED)
    for name, column in zip(columns, rows.columns, strict=True):
        column.justify = "right" if name in _NUMBERS else "left"
    for entity in entities:
        cells = _cells(entity)
        rows.add(*(cells[name] for name in columns))
    return rows


def _cells(e: Entity) -> dict[str, str]:
    x, y, z, yaw = pose_cells(_pose(e))
    label = e.preferred_reference or ""
    values = (e.name, e.class_, x, y, z, yaw, size_text(e), label, _body(e))
    return dict(zip(ENTITY_COLUMNS, values, strict=True))


def sort_entities(entities: Sequence[Entity], column: str | None) -> list[Entity]:
    """Return the entities in the order of one of `ENTITY_COLUMNS`; those without a value come last."""
    if column is None:
        return list(entities)

    def key(entity: Entity) -> tuple[bool, Any]:
        pose = _pose(entity)
        if column in _NUMBERS and pose is not None:
            return False, (*pose.position_m, pose.yaw_rad)[_NUMBERS.index(column)]
        if column == "size" and entity.size_m is not None:
            return False, math.prod(entity.size_m)
        text = "" if column in (*_NUMBERS, "size") else _cells(entity)[column]
        return not text, text or 0.0

    return sorted(entities, key=key)


def _pose(e: Entity) -> Pose | None:
    return e.pose if e.live is None else e.live.pose


def entity_line(entities: Sequence[Entity]) -> str:
    """Return the number of entities, and a hint if bodies could not be created."""
    failed = sum(e.body is not None and e.body.status == "failed" for e in entities)
    why = (
        f"; {wording.bodies(failed)} could not be created; for the reason see: semmap status"
        if failed
        else ""
    )
    others = sum(not e.in_space for e in entities)
    not_in_space = f" and {wording.counted(others, 'individual')} not in space" if others else ""
    return wording.entities(len(entities) - others) + not_in_space + why


def entity_card(e: Described, properties: Iterable[PropertyInfo] = ()) -> Table:
    """Return all data of one entity, with the labels of `properties`."""
    if not e.in_space:
        return _individual_card(e, properties)
    body = _body(e) + (f" ({e.body.detail})" if e.body is not None and e.body.detail else "")
    own_size = " (of the model)" if e.body is not None and e.body.own_size else ""
    rows = {
        "name": e.name,
        "iri": e.iri,
        "class": e.class_,
        "types": ", ".join(e.types),
        f"pose in {e.frame}" if e.frame else "pose": pose_text(e.pose),
        **({"live": _live(e)} if e.tracked or e.live is not None else {}),
        "size": (size_text(e) or "unknown") + own_size,
        **({"where": where} if (where := _where(e)) else {}),
        **({"problems": "; ".join(problems)} if (problems := _problems(e)) else {}),
        "label": e.preferred_reference or "none",
        "aliases": ", ".join(e.alternative_references) or "-",
    }
    after = {
        "body": body,
        **({"name in the world": e.body.body} if e.body is not None and e.body.body else {}),
        **(
            {"joints": ", ".join(map(in_words, e.body.joints))}
            if e.body is not None and e.body.joints
            else {}
        ),
        **({"perception": e.conflict} if e.conflict else {}),
        **({"shape": "world"} if e.shape == "world" else {"model": "-" if e.place else _model(e)}),
        "last change": provenance_text(e.provenance),
        **({"pose set": provenance_text(e.pose_provenance)} if e.pose is not None else {}),
        "class and size set": provenance_text(e.shape_provenance),
        **_label_set(e),
        **({"joints set": provenance_text(e.joint_provenance)} if e.joint_provenance is not None else {}),
        **({"switches set": provenance_text(e.switch_provenance)} if e.switch_provenance is not None else {}),
    }
    return _card(rows, _stated(e, {p.name: p for p in properties}), after)


def _card(before: dict[str, str], stated: Mapping[str, str], after: dict[str, str]) -> Table:
    """Return a card with properties in between. Those that are called like another row are marked."""
    taken = before.keys() | after.keys()
    marked = {f"{name} (property)" if name in taken else name: text for name, text in stated.items()}
    return card({**before, **marked, **after})


def _individual_card(e: Described, properties: Iterable[PropertyInfo]) -> Table:
    """Return all data of an individual that is not in space."""
    rows = {
        "name": e.name,
        "iri": e.iri,
        "class": e.class_,
        "types": ", ".join(e.types),
        "pose": "none: not in space",
        "label": e.preferred_reference or "none",
        "aliases": ", ".join(e.alternative_references) or "-",
    }
    after = {
        "referred to by": "; ".join(f"{p}: {wording.few(names)}" for p, names in e.referred_by.items())
        or "-",
        "last change": provenance_text(e.provenance),
        "class set": provenance_text(e.shape_provenance),
        **_label_set(e),
    }
    return _card(rows, _stated(e, {p.name: p for p in properties}), after)


def _label_set(e: Described) -> dict[str, str]:
    """Return the row of the last change of the labels, if the entity has any."""
    has_labels = e.preferred_reference or e.alternative_references
    return {"label set": provenance_text(e.reference_provenance)} if has_labels else {}


def _live(e: Entity) -> str:
    """Return the live pose with its age and source."""
    if holder := holder_of(e):
        source = f"the attachment to {holder}"
    else:
        source = "the simulator" if e.tracked == "sim" else "published poses"
    if e.live is None:
        return f"tracked from {source}; no pose received yet"
    stale = " (stale)" if e.live.stale else ""
    return f"{pose_text(e.live.pose)}; {wording.duration(e.live.age_s)} ago{stale}, from {source}"


def _stated(e: Entity, properties: Mapping[str, PropertyInfo]) -> dict[str, str]:
    """Return the properties with labels: `isOpen (is open)`, `color_red (red)`."""
    rows = {}
    for name, stated in e.properties.items():
        known = properties.get(name)
        values = stated if isinstance(stated, tuple) else (stated,)
        label = english(known.labels) if known else ""
        rows[labelled(name, label)] = ", ".join(
            labelled(value_in_words(value), _label(known, value)) for value in values
        )
    return rows


def _label(known: PropertyInfo | None, value: Value) -> str:
    return known.values.get(str(value), "") if known is not None else ""


def property_table(properties: Iterable[PropertyInfo]) -> Table:
    """Return a table with one row per property."""
    rows = table("property", "label", "domain", "range", "values", fold=("label", "domain", "range"))
    for p in properties:
        range_ = ", ".join(p.range) or ("a value" if p.kind == "data" else "an individual")
        count = "one" if p.functional else "any number"
        rows.add(p.name, english(p.labels), ", ".join(p.domain), range_, count)
    return rows


def rule_table(rules: Iterable[RuleInfo]) -> Table:
    """Return a table with one row per SWRL rule."""
    rows = table("holds", "name", "rule", fold=("name", "rule"))
    for rule in rules:
        no_effect = f"no effect: {rule.unsupported}" if rule.unsupported else ""
        holds = f"≥ {rule.holds}" if rule.at_least else str(rule.holds)
        rows.add("-" if no_effect else holds, rule.name, rule.text or no_effect)
    return rows


def class_tree(classes: Iterable[ClassInfo]) -> Tree:
    """Return the class tree with the number of entities per class, including inferred types."""
    by_name = {c.name: c for c in classes}
    children: dict[str, list[str]] = {}
    for c in by_name.values():
        for parent in c.parents or ("",):
            children.setdefault(parent, []).append(c.name)
    root = Tree(
        Text.assemble(
            ("classes", "bold"), (" (entities, inferred types included; asserted ones in brackets)", "dim")
        )
    )
    _grow(root, "", children, by_name)
    return root


def frame_tree(frames: Iterable[Frame]) -> Tree:
    """Return the frame tree, with the pose of each frame in its parent, or the reason why it is unusable."""
    branches: dict[str, Tree] = {}
    root = Tree(Text("frames", style="bold"))
    for f in frames:
        note = _frame_note(f)
        pose = Text(_frame_pose(f))
        label = Text.assemble((escaped(f.name), "bold"), "  " if pose else "", pose, (note, "dim"))
        above = branches.get(f.parent, root)
        if above is root and f.parent:
            label.append(f"  in {escaped(f.parent)}", "dim")
        branches[f.name] = above.add(label)
    return branches["map"] if len(root.children) == 1 else root


def _frame_pose(f: Frame) -> str:
    """Return the pose of a frame in its parent, with the quaternion if it is not a rotation about z."""
    if not f.parent or f.pose is None:
        return ""
    w, x, y, z = f.pose.orientation_wxyz
    if max(abs(x), abs(y)) < _LEVEL:
        return pose_text(f.pose)
    quaternion = " ".join(f"{value:.3f}" for value in (w, x, y, z))
    return f"{pose_text(f.pose).partition(', yaw')[0]}, wxyz {quaternion}"


def _frame_note(f: Frame) -> str:
    """Return the source, age and problem of a frame."""
    source = {"map": "", "sim": "the simulator", "stream": "a stream", "camera": "a camera"}[f.source]
    age = "" if f.age_s is None else f", {wording.duration(f.age_s)} ago"
    if f.source == "stream" and f.age_s is None and not f.problem:
        age = ", fixed"
    note = f"  from {source}{age}" if source and f.source != "camera" else f"  {source}" if source else ""
    return f"{note}  ({f.problem})" if f.problem else note


def status_table(status: SystemStatus) -> Table:
    """Return a table with one row per node, and the hosts if there are several."""
    errors = ("last error",) if any(n.last_error for n in status.nodes) else ()
    hosts = ("host",) if len({n.host for n in status.nodes}) > 1 else ()
    columns = ("node", *hosts, "state", "pid", "uptime", "heartbeat", "detail", *errors)
    rows = table(*columns, fold=("detail", *errors))
    for n in status.nodes:
        colour = {"ready": "green", "starting": "yellow"}.get(n.state, "red")
        rows.add(
            n.node,
            *((n.host,) if hosts else ()),
            Text(n.state, style=colour),
            str(n.pid),
            _duration(n.uptime_s),
            f"{n.heartbeat_age_s:.1f} s ago",
            n.detail,
            *((n.last_error,) if errors else ()),
        )
    return rows


def status_line(status: SystemStatus) -> str:
    """Return the state of the map and the scene in one line."""
    is_starting = any(node.node == "sim_node" and node.state == "starting" for node in status.nodes)
    without_scene = "the simulator is starting" if is_starting else "no simulator is running"
    verdicts = {
        True: "map and scene agree" + (", except for the problems below" if status.problems else ""),
        False: "map and scene do not agree yet",
        None: "the map is updated by perception only" if status.truth == "perceived" else without_scene,
    }
    agree = verdicts[status.in_agreement]
    counts = f"{wording.entities(status.entities)}, {wording.bodies(status.bodies)}, commit {status.commit}"
    of = f"; semmap {status.version}" if status.version else ""
    return f"{counts}; truth: {status.truth}; {agree}{of}"


def problem_lines(status: SystemStatus) -> Iterable[str]:
    """Yield the first problems of a status, and how many more there are."""
    yield from status.problems[:_MOST_PROBLEMS]
    if (more := len(status.problems) - _MOST_PROBLEMS) > 0:
        yield f"… and {wording.counted(more, 'more problem')}; to list all: semmap status --format json"


def status_notes(status: SystemStatus) -> Iterable[str]:
    """Yield the notes of the nodes, which are about the TBox and the world."""
    return (f"{wording.note_subject(node.node)}: {note}" for node in status.nodes for note in node.notes)


def commit_line(commit: Commit) -> str:
    """Return a commit as one line."""
    stamp = time.strftime("%H:%M:%S", time.localtime(commit.stamp_ns / 1e9))
    extent = commit.extent
    counts = f"+{extent.inserted} -{extent.retracted} triples"
    names = [e.name for e in commit.changed] + [f"-{gone.name}" for gone in commit.removed]
    if commit.abridged is not None:
        names = [wording.entities(extent.changed + extent.removed)]
    shown = " ".join(names[:8]) + (f" and {len(names) - 8} more" if len(names) > 8 else "")
    line = f"{stamp}  commit {commit.seq}  {author(commit)}: {commit.reason}  [{counts}]  {shown}"
    return printable(line).plain


def _where(e: Described) -> str:
    known = ", ".join(map(_without_measurement, e.whereabouts))
    return "; ".join(filter(None, (known, e.on_nothing.removeprefix(f"{e.name} is "))))


def _problems(e: Described) -> tuple[str, ...]:
    """Return the relations that do not hold and the suppressed facts."""
    return (*(relation.text for relation in e.denied), *e.withheld)


def _without_measurement(relation: Relation) -> str:
    """Return a relation without the measurement, which `semmap relations` prints."""
    return relation.text.removeprefix(f"{relation.subject} is ").partition(":")[0]


def _body(e: Entity) -> str:
    return "" if e.body is None else e.body.status


def _duration(seconds: float) -> str:
    minutes, s = divmod(int(seconds), 60)
    hours, m = divmod(minutes, 60)
    return f"{hours} h {m} min" if hours else f"{m} min {s} s" if m else f"{s} s"


def _grow(tree: Tree, parent: str, children: dict[str, list[str]], by_name: dict[str, ClassInfo]) -> None:
    for name in sorted(children.get(parent, [])):
        c = by_name[name]
        count = f"  {c.inferred}" if c.inferred else ""
        own = f" ({c.asserted})" if c.asserted and c.asserted != c.inferred else ""
        label = Text.assemble(name, (count, "bold green"), (own, "dim"))
        _grow(tree.add(label), name, children, by_name)


def _model(e: Entity) -> str:
    model = (e.body.model if e.body is not None else "") or e.model or "a box"
    return f"{model} (property model)" if "model" in e.properties else model


def history_table(commits: Iterable[LoggedCommit]) -> Table:
    """Return a table with one row per commit, and one per note."""
    columns = ("commit", "time", "author", "reason", "confidence", "changes")
    rows = table(*columns, fold=("author", "reason", "changes"))
    rows.columns[0].justify = "right"
    for c in commits:
        rows.add(
            str(c.seq),
            moment(c.stamp_ns),
            author(c),
            c.reason,
            "" if c.confidence is None else f"{c.confidence:.2f}",
            format_commit_changes(c),
        )
        for note in c.notes:
            rows.add("", "", "", "", "", f"note: {note}")
    return rows


def visit_table(visits: Iterable[Visit]) -> Table:
    """Return a table with one row per visit of a place."""
    rows = table("entity", "place", "from", "until", "duration", fold=())
    for visit in visits:
        until_ns = visit.until_ns or time.time_ns()
        rows.add(
            visit.name,
            visit.place,
            moment(visit.since_ns),
            "now"
            if visit.until_ns is None
            else f"{moment(visit.until_ns)}{'' if visit.left else ' or later'}",
            wording.duration(max(0, until_ns - visit.since_ns) / 1e9),
        )
    return rows


def sighting_card(s: Sighting) -> Table:
    """Return the last known pose of an entity, with its source."""
    rows = {"name": s.name, "where": pose_text(s.pose), "last change": provenance_text(s.provenance)}
    if s.removed is not None:
        rows["removed"] = provenance_text(s.removed)
    if s.seen_ns is not None:
        rows["last observed"] = moment(s.seen_ns)
    if s.removed is None or s.gone is not None:  # otherwise the row `removed` has the status
        rows["status"] = s.text
    return card(rows)
