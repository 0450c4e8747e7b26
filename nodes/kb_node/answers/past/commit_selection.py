"""Selection of commits of the history by their author, and by the place of what they changed."""

from __future__ import annotations

from collections.abc import Iterable, Set

from msgspec import Struct

from semmap.nodes.kb_node.answers.past.fact_intervals import PoseChanges
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.relations.selection import Targets, is_in, is_on, require_possible
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.schemas import errors, wording
from semmap.schemas.commands import History
from semmap.schemas.entities import Entity
from semmap.schemas.replies import LoggedCommit

_FEW = 5


class Authorship(Struct, frozen=True):
    """The author of a commit."""

    seq: int
    source: str
    agent: str = ""


def list_commits(
    journal: Journal,
    past: HistoryReader,
    query: History,
    limits: Thresholds,
    only: Set[int] | None = None,
) -> tuple[LoggedCommit, ...]:
    """Return the commits that a query selects, newest last; `only` are those that may be returned.

    Raises UnknownName, Refused, BadRequest.
    """
    if query.by is not None:
        by = find_commits_by(journal.decode_partially(Authorship), query.by)
        only = by if only is None else only & by
    for how, word in (("in", query.in_), ("on", query.on)):
        if word is None:
            continue
        names = past.list_names(past.resolve(word, past.entities(past.last) if past.last else ()))
        first = past.initial_entities().values()
        there = find_commits_at(journal.decode_partially(PoseChanges), first, names, limits, on=how == "on")
        only = there if only is None else only & there
    return past.history(query, only)


def find_commits_by(commits: Iterable[Authorship], author: str) -> set[int]:
    """Return the commits of an author: an agent, a source, or `source/agent`. Raises UnknownName."""
    wanted = author.casefold()
    found: set[int] = set()
    known: dict[str, None] = {}
    for commit in commits:
        names = [commit.source, *((commit.agent, f"{commit.source}/{commit.agent}") if commit.agent else ())]
        known.update(dict.fromkeys(names[:2]))
        if wanted in (name.casefold() for name in names):
            found.add(commit.seq)
    if not found:
        authors = sorted(known)
        hint = errors.did_you_mean(author, authors) or f"; the authors are {wording.few(authors, _FEW)}"
        raise errors.UnknownName(f"no commit is by '{author}'{hint if authors else ''}")
    return found


def find_commits_at(
    history: Iterable[PoseChanges],
    first: Iterable[Entity],
    names: Iterable[tuple[int, str]],
    limits: Thresholds,
    *,
    on: bool,
) -> set[int]:
    """Return the commits that changed something in a place or container, before or after the change.

    With `on`, return those that changed something on an object. `history` are the commits in order, and
    `first` the entities before them. `names` are those of the place, by the commits that gave them, 0 for the
    first name. Raises Refused if nothing can be in or on the entity.
    """
    space = Space(first, limits)
    holders_since = {seq: frozenset((name,)) for seq, name in names}
    holders = holders_since[0]
    holds = is_on if on else is_in

    def are_there(changed: Iterable[str], holders: Set[str]) -> bool:
        solids = filter(None, map(space.solids.get, changed))
        return any(holds(space, solid, holders, frozenset()) for solid in solids)

    found: set[int] = set()
    for moves in history:
        changed = [*(each.name for each in moves.changed), *(each.name for each in moves.removed)]
        was_there = are_there(changed, holders)
        for each in moves.removed:
            space.remove(each.name)
        placed: list[PlacedEntity] = [each.placed for each in moves.changed]
        for _ in space.put_all(placed):
            pass
        holders = holders_since.get(moves.seq, holders)
        if was_there or are_there(changed, holders):
            found.add(moves.seq)
    if not holders.isdisjoint(space.solids):
        require_possible(space, Targets(holders if on else None, None if on else holders, None, None))
    return found
