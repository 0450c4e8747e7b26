"""The history of an individual that is not in space, from the triples about it in the journal.

Commits are indexed by entity only, so all of them are read.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import lru_cache

from msgspec import Struct, structs

from semmap.nodes.kb_node.answers.past import commit_selection
from semmap.nodes.kb_node.entities.property_values import to_json_value
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.ontology import vocabulary as v
from semmap.schemas.changes import Change, of_properties, removed
from semmap.schemas.commands import History, Rename, Undo
from semmap.schemas.entities import Stated, Value
from semmap.schemas.explanations import Term, Triple
from semmap.schemas.replies import LoggedCommit

_Values = Mapping[Term, frozenset[Term]]


class TripleChanges(Struct, frozen=True):
    """The part of a commit that determines the asserted triples after it."""

    seq: int
    verb: str = ""
    retracted: tuple[Triple, ...] = ()
    inserted: tuple[Triple, ...] = ()


class _Kind(Struct, frozen=True):
    seq: int
    verb: str = ""


def list_commits(
    journal: Journal, past: HistoryReader, query: History, limits: Thresholds, term: Term | None
) -> tuple[LoggedCommit, ...]:
    """Return the commits that changed what is asserted about an individual, newest last.

    `term` is its IRI, also that of a removed one; None stands for the removed individuals with the name of
    the query. Raises UnknownName, also for a name that no individual ever had, Refused, BadRequest.
    """
    word = query.name or ""
    renames = list(_find_renames(journal)) if term is not None else []
    first = journal.snapshot().all_triples() if journal.beginning.seq else ()
    found = find_changes(journal.decode_partially(TripleChanges), first, word, term, renames)
    if not found:
        past.require_known(word)
    others = structs.replace(query, name=None)
    listed = commit_selection.list_commits(journal, past, others, limits, found.keys())
    return tuple(structs.replace(commit, changes=found.get(commit.seq, ())) for commit in listed)


def find_changes(
    history: Iterable[TripleChanges],
    first: Iterable[Triple],
    word: str,
    term: Term | None = None,
    renames: Iterable[tuple[int, Term, Term]] = (),
) -> dict[int, tuple[Change, ...]]:
    """Return the changes of an individual by commit; `list_commits` explains `word` and `term`.

    `history` are the commits in order, `first` the triples before them, and `renames` the commits that
    renamed an individual, in order, with its earlier and its new IRI.
    """
    names = _list_names(term, renames) if term is not None else []

    @lru_cache(maxsize=1024)
    def is_named(subject: Term) -> bool:
        return subject.startswith("<") and v.own_name(subject) == word

    def selector(seq: int) -> Callable[[Term], bool]:
        if not names:
            return is_named
        present = next(name for since, name in names if since <= seq)
        return lambda subject: subject == present

    is_it = selector(0)
    known = {(p, o) for s, p, o in first if is_it(s)}
    found: dict[int, tuple[Change, ...]] = {}
    for commit in history:
        was_it, is_it = is_it, selector(commit.seq)
        gone = {(p, o) for s, p, o in commit.retracted if was_it(s)}
        come = {(p, o) for s, p, o in commit.inserted if is_it(s)}
        if not gone and not come:
            continue
        before, known = known, (known - gone) | come
        earlier = next((old for seq, old, new in renames if seq == commit.seq and is_it(new)), None)
        subject = next(filter(is_it, (s for s, _, _ in commit.inserted)), None)
        name = word if subject is None else v.own_name(subject)
        found[commit.seq] = tuple(_compare(name, before, known, earlier))
    return found


def _compare(
    name: str, before: set[tuple[Term, Term]], after: set[tuple[Term, Term]], earlier: Term | None
) -> Iterator[Change]:
    was, now = _by_property(before), _by_property(after)
    if not before:
        yield Change(name=name, kind="added", now=_class_of(now))
    elif not after:
        yield removed(name, _class_of(was))
    else:
        if earlier is not None:
            yield Change(name=name, kind="name", was=v.own_name(earlier), now=name)
        properties = sorted(was.keys() | now.keys(), key=v.local_name)
        yield from of_properties(
            name, ((v.local_name(p), _to_stated(was.get(p)), _to_stated(now.get(p))) for p in properties)
        )


def _by_property(values: Iterable[tuple[Term, Term]]) -> _Values:
    found: dict[Term, set[Term]] = {}
    for p, o in values:
        found.setdefault(p, set()).add(o)
    return {p: frozenset(terms) for p, terms in found.items()}


def _class_of(values: _Values) -> str:
    classes = values.get(v.RDF_TYPE, frozenset()) - {v.OWL_NAMED_INDIVIDUAL}
    return v.local_name(min(classes, default=v.OWL_THING))


def _to_stated(terms: frozenset[Term] | None) -> Stated | None:
    if not terms:
        return None
    values = tuple(map(_to_value, sorted(terms)))
    return values[0] if len(values) == 1 else values


def _to_value(term: Term) -> Value:
    if term.startswith('"'):
        return to_json_value(term)
    return "a value without a name" if term.startswith("_:") else v.entity_name(term)


def _find_renames(journal: Journal) -> Iterator[tuple[int, Term, Term]]:
    """Yield the commits that renamed an individual, with its earlier and its new IRI."""
    verbs = (Rename.VERB, Undo.VERB)
    found: dict[int, tuple[Term, Term]] = {}
    for seq in [each.seq for each in journal.decode_partially(_Kind) if each.verb in verbs]:
        commit = journal.commit(seq)
        if commit.verb == Rename.VERB:
            renamed = find_rename(commit.retracted, commit.inserted)
        else:
            gone, come = ({s for s, _, _ in triples} for triples in (commit.retracted, commit.inserted))
            undone = (found[each] for each in commit.undoes if each in found)
            renamed = next(((new, old) for old, new in undone if new in gone and old in come), None)
        if renamed is not None:
            found[seq] = renamed
            yield seq, *renamed


def find_rename(retracted: Iterable[Triple], inserted: Iterable[Triple]) -> tuple[Term, Term] | None:
    """Return the earlier and the new IRI of the one individual with the same statements under another IRI.

    Statements about itself are the same if their value changes with the IRI.
    """
    before, after = _by_subject(retracted), _by_subject(inserted)
    pairs = [(s, new) for s, about in before.items() for new in after if s != new and after[new] == about]
    return pairs[0] if len(pairs) == 1 else None


def _by_subject(triples: Iterable[Triple]) -> dict[Term, set[tuple[Term, Term]]]:
    """Return properties and values by subject; the subject itself is the value ''."""
    found: dict[Term, set[tuple[Term, Term]]] = {}
    for s, p, o in triples:
        found.setdefault(s, set()).add((p, "" if o == s else o))
    return found


def _list_names(term: Term, renames: Iterable[tuple[int, Term, Term]]) -> list[tuple[int, Term]]:
    """Return the IRIs of an individual, newest first, each with the commit that gave it, 0 for the first."""
    names: list[tuple[int, Term]] = []
    for seq, earlier, new in reversed(list(renames)):
        if new == term:
            names.append((seq, term))
            term = earlier
    return [*names, (0, term)]
