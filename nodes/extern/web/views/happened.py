"""What has happened, in words: a line a commit, as `semmap history` says it, and what nodes warn of."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from datetime import datetime
from typing import Any, Final, NamedTuple

from semmap.nodes.extern.cli.output.lines import format_commit_changes
from semmap.nodes.extern.phrasing import author
from semmap.schemas.health import Health
from semmap.schemas.replies import LoggedCommit

WARNING: Final = "warning"
MOST: Final = 2000
"""Lines that are kept."""


class Line(NamedTuple):
    """One line of the log. `commit` is None for what a node says."""

    stamp_ns: int
    commit: int | None
    by: str
    kind: str
    """The source of a commit, or "warning"."""
    text: str
    names: tuple[str, ...] = ()


class Log:
    """The lines, the newest first; commits each once, whatever order they are told in."""

    def __init__(self) -> None:
        self.lines: list[Line] = []
        self._seqs: set[int] = set()
        self._warned: dict[str, str] = {}

    @property
    def last(self) -> int:
        """The newest commit that it has; 0 for none."""
        return max(self._seqs, default=0)

    def clear(self) -> None:
        """Begin anew, with another map."""
        self.lines.clear()
        self._seqs.clear()

    def take(self, commits: Iterable[LoggedCommit]) -> None:
        """Take over commits."""
        for commit in commits:
            if commit.seq not in self._seqs:
                self._seqs.add(commit.seq)
                self._add(line_of(commit))

    def hear(self, health: Health) -> None:
        """Take over what a node warns of, once for as long as it does."""
        if health.last_error and self._warned.get(health.node) != health.last_error:
            self._add(Line(health.stamp_ns, None, health.node, WARNING, health.last_error))
        self._warned[health.node] = health.last_error

    def _add(self, line: Line) -> None:
        self.lines.append(line)
        self.lines.sort(key=lambda known: (-known.stamp_ns, -(known.commit or 0)))
        for old in self.lines[MOST:]:
            self._seqs.discard(old.commit or 0)
        del self.lines[MOST:]


def line_of(commit: LoggedCommit) -> Line:
    """A commit in words: why, and what it did to what."""
    reason = f"{commit.reason}: " if commit.reason else f"{commit.verb}: " if commit.verb else ""
    notes = "".join(f" ({note})" for note in commit.notes)
    names = tuple(dict.fromkeys((*commit.changed, *commit.removed)))
    text = f"{reason}{format_commit_changes(commit)}{notes}"
    return Line(commit.stamp_ns, commit.seq, author(commit), commit.source, text, names)


def rows_of(lines: Iterable[Line], wanted: str = "", kinds: Collection[str] = ()) -> list[dict[str, Any]]:
    """The lines as rows of a table; those with every word of `wanted`, and of `kinds` unless it is empty.

    Kinds are sources of commits ("operator", ...) and "warning".
    """
    words = wanted.casefold().split()
    rows = []
    for i, line in enumerate(lines):
        row = {
            "id": f"c{line.commit}" if line.commit is not None else f"w{line.stamp_ns}.{i}",
            "time": clock(line.stamp_ns),
            "commit": "" if line.commit is None else str(line.commit),
            "by": line.by,
            "text": line.text,
            "names": list(line.names),
            "kind": line.kind,
        }
        said = f"{row['commit']} {line.by} {line.text}".casefold()
        if (not kinds or line.kind in kinds) and all(word in said for word in words):
            rows.append(row)
    return rows


def clock(stamp_ns: int) -> str:
    """A local time; of another day than today with its date."""
    then = datetime.fromtimestamp(stamp_ns / 1e9)
    today = then.date() == datetime.now().date()
    return f"{then:%H:%M:%S}" if today else f"{then:%Y-%m-%d %H:%M:%S}"
