"""Formats commits as text: one line for the log, a page of Markdown for the viewer."""

from __future__ import annotations

from datetime import UTC, datetime

from semmap.ontology import vocabulary as v
from semmap.ontology.entity_triples import find_earlier_names
from semmap.schemas import wording
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Entity
from semmap.schemas.explanations import Triple

_LINES = 40
"""Maximum number of triples on a page. The recording holds all of them."""


def headline(commit: Commit) -> str:
    """Summarise a commit in one line: `12  operator ann: add beer1 (+9 -0)`."""
    who = f"{commit.source} {commit.agent}".strip()
    why = commit.reason or _entities(commit)
    extent = commit.extent
    return f"{commit.seq}  {who}: {why} (+{extent.inserted} -{extent.retracted})"


def page(commit: Commit) -> str:
    """Format a commit as Markdown: source, time, reason, changed entities, notes and triples."""
    when = datetime.fromtimestamp(commit.stamp_ns / 1e9, UTC).strftime("%Y-%m-%d %H:%M:%S UTC")
    who = f"**{commit.source}** {commit.agent}".strip()
    sure = "" if commit.confidence is None else f" · confidence {commit.confidence:.2f}"
    earlier = find_earlier_names(commit)
    sections = [
        f"# Commit {commit.seq}",
        f"{who} · {when}{sure}",
        commit.reason,
        *(_bullet(entity, earlier.get(entity.name)) for entity in commit.changed[:_LINES]),
        *(
            f"- **{gone.name}** left the map"
            for gone in commit.removed[:_LINES]
            if gone.name not in earlier.values()
        ),
        *(f"> {note}" for note in commit.notes),
        _triples("Added", "+", commit.inserted),
        _triples("Removed", "-", commit.retracted),
        _triples("Measured", "+", commit.places.came if commit.places else ()),
        _triples("No longer measured", "-", commit.places.went if commit.places else ()),
        f"`{commit.id}`",
    ]
    return "\n\n".join(section for section in sections if section)


def _entities(commit: Commit) -> str:
    if commit.abridged is not None:
        return wording.entities(commit.abridged.changed + commit.abridged.removed)
    names = [entity.name for entity in commit.changed] + [gone.name for gone in commit.removed]
    more = f" and {len(names) - 3} more" if len(names) > 3 else ""
    return ", ".join(names[:3]) + more or "no entity"


def _bullet(entity: Entity, earlier: str | None) -> str:
    where = "" if earlier is None else f", renamed from **{earlier}**,"
    if entity.pose is not None:
        x, y, z = entity.pose.position_m
        where += f" at ({x:.2f}, {y:.2f}, {z:.2f})"
    return f"- **{entity.name}**, a {entity.class_}{where}"


def _triples(title: str, sign: str, triples: tuple[Triple, ...]) -> str:
    if not triples:
        return ""
    lines = [f"{sign} {v.to_words(triple)}" for triple in triples[:_LINES]]
    if len(triples) > _LINES:
        lines.append(f"  ... and {len(triples) - _LINES} more")
    return "\n".join([f"**{title}** ({len(triples)})", "", "```", *lines, "```"])
