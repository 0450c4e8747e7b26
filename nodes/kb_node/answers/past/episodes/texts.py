"""Episodes and times as text."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import date, datetime

from semmap.schemas.episodes import Episode
from semmap.schemas.wording import duration

_MOST = 5


def clock(ns: int) -> str:
    """Return a time as `10:03:22`, with its date if that is not today."""
    at = datetime.fromtimestamp(ns / 1e9)
    return f"{at:%H:%M:%S}" if at.date() == date.today() else f"{at:%Y-%m-%d %H:%M:%S}"


def begin(episode: Episode) -> str:
    """Return `10:03:22 (commit 7)`, or that it began before the history."""
    if episode.since == 0:
        return f"before the history begins ({clock(episode.since_ns)})"
    by = f" by {episode.by}" if episode.by else ""
    return f"{clock(episode.since_ns)} ({f'commit {episode.since}' if episode.since else 'live poses'}{by})"


def end(episode: Episode) -> str:
    """Return `10:05:00 (commit 8)`, or `now` for what is still so."""
    if episode.until_ns is None:
        return "now"
    return f"{clock(episode.until_ns)} ({f'commit {episode.until}' if episode.until else 'live poses'})"


def span(episode: Episode) -> str:
    """Return `from 10:03:22 (commit 7) to 10:05:00 (commit 8)`, or `since ...`."""
    if episode.until_ns is None:
        return f"since {begin(episode)}"
    return f"from {begin(episode)} to {end(episode)}"


def listed(texts: Sequence[str]) -> str:
    """Return at most five texts, with the number of the others before the last one."""
    if len(texts) > _MOST:
        texts = [*texts[: _MOST - 1], f"... {len(texts) - _MOST} more ...", texts[-1]]
    return ", ".join(texts)


def lasted(seconds: float) -> str:
    """Return a duration, with the exact number of seconds if it is rounded."""
    text = duration(seconds)
    return text if seconds < 120 else f"{text} ({seconds:.0f} s)"
