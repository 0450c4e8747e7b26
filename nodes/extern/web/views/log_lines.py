"""Lines of the log: commits, as `semmap history` prints them, and errors of nodes."""

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
"""Maximum number of lines."""


class Line(NamedTuple):
    """One line of the log. `commit` is None for an error of a node."""

    stamp_ns: int
    commit: int | None
    by: str
    kind: str
    """The source of a commit, or "warning"."""
    text: str
    names: tuple[str, ...] = ()


class Log:
    """The lines, the newest first. Commits may be added in any order, and repeatedly."""

    def __init__(self) -> None:
        self.lines: list[Line] = []
        self._seqs: set[int] = set()
        self._errors: dict[str, str] = {}

    @property
    def last(self) -> int:
        """The newest commit; 0 without commits."""
        return max(self._seqs, default=0)

    def clear(self) -> None:
        """Remove all lines."""
        self.lines.clear()
        self._seqs.clear()

    def add_commits(self, commits: Iterable[LoggedCommit]) -> None:
        """Add the commits that are not in the log."""
        for commit in commits:
            if commit.seq not in self._seqs:
                self._seqs.add(commit.seq)
                self._add(line_of(commit))

    def add_health(self, health: Health) -> None:
        """Add the last error of a node, once for as long as it does not change."""
        if health.last_error and self._errors.get(health.node) != health.last_error:
            self._add(Line(health.stamp_ns, None, health.node, WARNING, health.last_error))
        self._errors[health.node] = health.last_error

    def _add(self, line: Line) -> None:
        self.lines.append(line)
        self.lines.sort(key=lambda known: (-known.stamp_ns, -(known.commit or 0)))
        for old in self.lines[MOST:]:
            self._seqs.discard(old.commit or 0)
        del self.lines[MOST:]


def line_of(commit: LoggedCommit) -> Line:
    """Return the line of a commit: its reason and its changes."""
    reason = f"{commit.reason}: " if commit.reason else f"{commit.verb}: " if commit.verb else ""
    notes = "".join(f" ({note})" for note in commit.notes)
    names = tuple(dict.fromkeys((*commit.changed, *commit.removed)))
    text = f"{reason}{format_commit_changes(commit)}{notes}"
    return Line(commit.stamp_ns, commit.seq, author(commit), commit.source, text, names)


def rows_of(lines: Iterable[Line], search: str = "", kinds: Collection[str] = ()) -> list[dict[str, Any]]:
    """Return table rows for the lines that contain all words of `search` and are of one of the `kinds`.

    Kinds are sources of commits ("operator", ...) and "warning". Without kinds all lines match.
    """
    words = search.casefold().split()
    rows = []
    for i, line in enumerate(lines):
        row = {
            "id": f"c{line.commit}" if line.commit is not None else f"w{line.stamp_ns}.{i}",
            "time": format_time(line.stamp_ns),
            "commit": "" if line.commit is None else str(line.commit),
            "by": line.by,
            "text": line.text,
            "names": list(line.names),
            "kind": line.kind,
        }
        text = f"{row['commit']} {line.by} {line.text}".casefold()
        if (not kinds or line.kind in kinds) and all(word in text for word in words):
            rows.append(row)
    return rows


def format_time(stamp_ns: int) -> str:
    """Return a local time, with the date if it is not today."""
    then = datetime.fromtimestamp(stamp_ns / 1e9)
    today = then.date() == datetime.now().date()
    return f"{then:%H:%M:%S}" if today else f"{then:%Y-%m-%d %H:%M:%S}"
