"""History and sightings as tables and cards for a terminal."""

from __future__ import annotations

from collections.abc import Iterable

from rich.table import Table

from semmap.nodes.extern.cli.output.lines import format_commit_changes
from semmap.nodes.extern.cli.output.tables import card, table
from semmap.nodes.extern.phrasing import author, moment, pose_text, provenance_text
from semmap.schemas.replies import LoggedCommit, Sighting


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
