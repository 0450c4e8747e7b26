"""Undoes a commit by another commit: which commits are included, and whether later ones depend on it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from itertools import chain

from semmap.nodes.kb_node import preconditions
from semmap.nodes.kb_node.documents.tbox import tbox_validation
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.runtime import memory
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.bridge import TakeBack
from semmap.schemas.commits import Commit, Transaction
from semmap.schemas.entities import LESSER
from semmap.schemas.explanations import Triple


def undo(
    semantic_map: SemanticMap,
    journal: Journal,
    command: TakeBack,
    working: Callable[[Commit], AbstractContextManager[object]] = nullcontext,
) -> Commit:
    """Undo a commit with the settling that followed it, or restore the TBox that it replaced.

    The work is done within `working(commit)` of the undone commit.

    Raises Inconsistent, and Refused if there is nothing to undo, later commits depend on it, its author has a
    higher authority, or the map does not fit the previous TBox.
    """
    if (known := journal.commit_of(command.id)) is not None:
        return known
    target = _newest_client_commit(journal) if command.commit is None else _named(journal, command.commit)
    _require_authority(command, target)
    reverse = _reverse_tbox if target.tbox else _reverse
    try:
        with memory.uncollected(), working(target):
            commit = reverse(semantic_map, journal, command, target)
    except errors.Inconsistent as error:
        raise errors.Inconsistent(
            f"commit {target.seq} cannot be undone: {error.text}", explanation=error.explanation
        ) from None
    except tbox_validation.DoesNotFit as error:
        raise errors.Refused(
            f"commit {target.seq} cannot be undone: {error.text}; first remove or update what does not fit,"
            " or load another TBox: semmap load --tbox FILE"
        ) from None
    if commit is None:
        raise errors.Refused(f"there is nothing left of commit {target.seq} to undo")
    return commit


def _reverse(semantic_map: SemanticMap, journal: Journal, command: TakeBack, target: Commit) -> Commit | None:
    later = _later_commits(journal, target)
    _require_in_force(
        target, later if target.names else map(journal.commit, journal.list_undo_commits(target.seq))
    )
    settling = [commit for commit in _in_force(later) if _is_settling(commit)]
    undone = [target, *reversed(settling)]
    retract, insert = _net(undone)
    if _has_changed(semantic_map, retract, insert):
        raise errors.Refused(_dependency_error(target, [c for c in later if c not in undone]))
    return semantic_map.commit(_transaction(command, undone, retract, insert, require=retract))


def _reverse_tbox(semantic_map: SemanticMap, journal: Journal, command: TakeBack, target: Commit) -> Commit:
    """Restore the previous TBox, and the facts that the commit changed, with their settling."""
    later = [journal.commit(seq) for seq in journal.tbox_changes(after=target.seq)]
    _require_in_force(target, later)
    if again := [commit for commit in _in_force(later) if not commit.undoes]:
        raise errors.Refused(_dependency_error(target, again))
    before, after = (semantic_map.tbox_at(seq) for seq in (target.seq - 1, target.seq))
    undone = [target]
    if any(t not in after and t[1] != v.OWL_IMPORTS for t in target.inserted):  # it also loaded a map
        undone += [c for c in _in_force(_later_commits(journal, target)) if _is_settling(c)][::-1]
    inserted, retracted = _net(undone)
    retract = tuple(t for t in inserted if t not in after)
    insert = tuple(t for t in retracted if t not in before and not semantic_map.is_asserted(t))
    gone = {t for t in retract if not semantic_map.is_asserted(t)}
    if changed := next((t for t in retract if t in gone and t[1] != v.OWL_IMPORTS), None):
        raise errors.Refused(
            f"commit {target.seq} cannot be undone: its facts were changed later, such as"
            f" {v.to_words(changed)}; undo the later commits first"
        )
    retract = tuple(t for t in retract if t not in gone)
    return semantic_map.replace_tbox(_transaction(command, undone, retract, insert), before)


def _transaction(
    command: TakeBack,
    undone: Sequence[Commit],
    retract: tuple[Triple, ...],
    insert: tuple[Triple, ...],
    *,
    require: tuple[Triple, ...] = (),
) -> Transaction:
    target = undone[0]
    return Transaction(
        id=command.id,
        source=command.source,
        agent=command.agent,
        verb="undo",
        reason=command.reason or f"undo {target.seq}: {target.reason}",
        undoes=tuple(commit.seq for commit in undone),
        require=require,
        retract=retract,
        insert=insert,
    )


def _require_in_force(target: Commit, later: Iterable[Commit]) -> None:
    for commit in _in_force(later):
        if target.seq in commit.undoes:
            raise errors.Refused(f"commit {target.seq} was already undone by commit {commit.seq}")


def _newest_client_commit(journal: Journal) -> Commit:
    """Return the newest commit that a client requested and that is not undone."""
    backwards = (journal.commit(seq) for seq in range(journal.last, journal.first - 1, -1))
    for commit in _in_force(backwards):
        if commit.verb and not commit.undoes:
            return commit
    raise errors.Refused(
        "there is nothing to undo: no client has changed the map, or everything has been undone"
    )


def _named(journal: Journal, seq: int) -> Commit:
    if seq > journal.last:
        raise errors.Refused(f"there is no commit {seq} yet; the last one is {journal.last}")
    if seq < journal.first:
        raise errors.Refused(
            f"commit {seq} cannot be undone: it has been compacted, and the history begins with commit"
            f" {journal.first}"
        )
    return journal.commit(seq)


def _require_authority(command: TakeBack, target: Commit) -> None:
    if command.source in LESSER and target.source not in LESSER:
        raise errors.Refused(f"commit {target.seq} was made by an operator, so only an operator may undo it")


def _later_commits(journal: Journal, target: Commit) -> list[Commit]:
    """Return the later commits that concern `target`, newest first.

    These are the commits that touched one of its entities, and what the system did by itself right after it.
    For example, objects fall when the table under them is removed.
    """
    if target.seq == journal.last:
        return []
    seqs = {seq for name in target.names for seq in journal.touching(name, after=target.seq)}
    found = {seq: journal.commit(seq) for seq in seqs}
    for seq in range(target.seq + 1, journal.last + 1):
        commit = found.get(seq) or journal.commit(seq)
        if commit.verb:
            break
        found[seq] = commit
    return [found[seq] for seq in sorted(found, reverse=True)]


def _in_force(newest_first: Iterable[Commit]) -> Iterator[Commit]:
    """Yield the commits that are not undone."""
    undone: set[int] = set()
    for commit in newest_first:
        if commit.seq not in undone:
            undone.update(commit.undoes)
            yield commit


def _is_settling(commit: Commit) -> bool:
    """Return whether the system itself only recorded where bodies came to rest."""
    shaped = any(entity.shape_provenance.commit == commit.seq for entity in commit.changed)
    return not commit.verb and commit.source == "scene" and not commit.removed and not shaped


def _net(commits: Sequence[Commit]) -> tuple[tuple[Triple, ...], tuple[Triple, ...]]:
    """Return the net inserted and retracted triples of commits in order."""
    if len(commits) == 1:
        return commits[0].inserted, commits[0].retracted
    inserted: dict[Triple, None] = {}
    retracted: dict[Triple, None] = {}
    for commit in commits:
        for triple in commit.retracted:
            if triple in inserted:
                del inserted[triple]
            else:
                retracted[triple] = None
        for triple in commit.inserted:
            if triple in retracted:
                del retracted[triple]
            else:
                inserted[triple] = None
    return tuple(inserted), tuple(retracted)


def _has_changed(
    semantic_map: SemanticMap, inserted: tuple[Triple, ...], retracted: tuple[Triple, ...]
) -> bool:
    """Return whether the result of the commits has changed or has been extended since."""
    own, reasoner, with_progress = set(inserted), semantic_map.reasoner, semantic_map.with_progress
    changed = {s for s, p, _ in retracted if p == v.RDF_TYPE}
    brought = {s for s, p, _ in inserted if p == v.RDF_TYPE} - changed
    if preconditions.is_large_share((inserted, retracted), reasoner):
        held = set(chain.from_iterable(with_progress(reasoner.by_subject())))
        about = [t for t in held - own if t[0] in brought or t[2] in brought]
    else:
        held = preconditions.find_asserted(reasoner, (inserted, retracted), semantic_map.progress)
        asserted = chain.from_iterable(
            chain(reasoner.asserted(term), reasoner.asserted(None, None, term))
            for term in with_progress(brought)
        )
        about = [t for t in asserted if t not in own]
    return bool(about) or not held >= own or not held.isdisjoint(retracted)


def _dependency_error(target: Commit, others: list[Commit]) -> str:
    """Return the error text.

    `others` are later commits, newest first; pairs that undo each other do not count.
    """
    seqs = {commit.seq for commit in others}
    changes = (c for c in _in_force(others) if not (c.undoes and seqs.issuperset(c.undoes)))
    if (newest := next(changes, None)) is None:
        return f"commit {target.seq} cannot be undone: its result has changed since"
    return (
        f"commit {target.seq} ({target.reason}) cannot be undone: commit {newest.seq} ({newest.reason})"
        f" depends on it; undo that one first: semmap undo {newest.seq}"
    )
