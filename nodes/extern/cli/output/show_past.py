"""The past as a person reads it in a terminal."""

from __future__ import annotations

from collections.abc import Iterable

from rich.table import Table

from nodes.extern.cli.output.tables import author, card, moment, pose_text, provenance_text, table
from schemas.replies import LoggedCommit, Sighting

_FEW = 6


def history_table(commits: Iterable[LoggedCommit]) -> Table:
    """One row a commit."""
    columns = ("commit", "time", "by", "why", "sure", "triples", "entities")
    rows = table(*columns, fold=("by", "why", "triples", "entities"))
    rows.columns[0].justify = "right"
    for c in commits:
        names = [*c.changed, *(f"-{name}" for name in c.removed)]
        more = f" and {len(names) - _FEW} more" if len(names) > _FEW else ""
        rows.add(
            str(c.seq),
            moment(c.stamp_ns),
            author(c),
            c.reason,
            "" if c.confidence is None else f"{c.confidence:.2f}",
            f"+{c.inserted} -{c.retracted}" + (" TBox" if c.tbox else ""),
            " ".join(names[:_FEW]) + more,
        )
    return rows


def sighting_card(s: Sighting) -> Table:
    """Where an entity was last, and by whose word."""
    rows = {"name": s.name, "where": pose_text(s.pose), "last change": provenance_text(s.provenance)}
    if s.removed is not None:
        rows["removed"] = provenance_text(s.removed)
    return card(rows)
