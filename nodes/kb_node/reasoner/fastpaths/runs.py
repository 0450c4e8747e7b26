"""Triples split into runs about new individuals, and recognised by their form.

Two runs have the same *form* if they differ only in the names of the new individuals, and in the other
individuals and literals to which these are related. A run of a known form is recognised as a whole. Other
runs are read term by term.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from operator import itemgetter
from typing import NamedTuple, TypeVar

from semmap.nodes.kb_node.reasoner.abox.kinds import Kind, Kinds
from semmap.nodes.kb_node.reasoner.abox.store import Store
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.terms import TYPE, is_literal

Tokens = tuple[tuple[int, Term, int | Term | None], ...]
"""A run without names, triple by triple: an individual is its place, any other object is None."""
Terms = tuple[Term, ...]
_T = TypeVar("_T")
Parts = tuple[tuple[_T, ...], tuple[_T, ...]]
_QUOTE, _FIRST = '"', itemgetter(0)
_LONGEST = 64
"""Maximum number of triples of a run with a form. Entities of a home have about 20."""
_MOST = 2000
"""Number of cached forms."""
_TRIED = 8
"""Maximum number of forms with the same beginning to compare a run with."""


class Form:
    """The common structure of the triples of runs. There is one object for each form."""

    __slots__ = (
        "_expected",
        "_fixed",
        "_individuals",
        "_others",
        "_predicates",
        "beginning",
        "classes",
        "length",
        "tokens",
    )

    def __init__(self, tokens: Tokens) -> None:
        self.tokens = tokens
        self.length = len(tokens)
        self.beginning = _beginning(*tokens[0][1:])
        self._predicates = tuple([p for _, p, _ in tokens])
        terms = [s for s, _, _ in tokens] + [o for _, _, o in tokens]
        places = sorted({word for word in terms if isinstance(word, int)})
        self.classes = tuple(dict.fromkeys(word for word in terms if isinstance(word, str)))
        fixed = [at for at, word in enumerate(terms) if word is not None]
        known = [*places, *self.classes]
        self._individuals = _picker([terms.index(place) for place in places])
        self._fixed = _picker(fixed)
        self._expected = _picker([known.index(terms[at]) for at in fixed])
        self._others = _picker([at for at, word in enumerate(terms) if word is None])

    def terms_of(self, triples: Sequence[Triple]) -> Terms | None:
        """Return the subjects, then the objects; None if the predicates differ."""
        subjects, predicates, objects = zip(*triples)  # noqa: B905, it is quicker
        return subjects + objects if predicates == self._predicates else None

    def parts(self, terms: tuple[_T, ...], classes: tuple[_T, ...]) -> Parts[_T] | None:
        """Return the individuals and the other objects among `terms`; None if they have another form.

        `terms` are those of one run, or columns for many runs. Then the classes are columns, too.
        """
        individuals = self._individuals(terms)
        if self._expected(individuals + classes) != self._fixed(terms):
            return None
        return individuals, self._others(terms)


class Run(NamedTuple):
    """Consecutive triples. All subjects except the first are objects of earlier triples of the run."""

    form: Form | None
    """None if a subject is not a new individual, or if the run is too long."""
    triples: Sequence[Triple]
    individuals: Terms
    """The new individuals."""
    others: Terms
    """The other objects, triple by triple."""
    kinds: tuple[Kind, ...]
    """The kinds of the other objects."""

    @property
    def shape(self) -> Shape:
        """The form and the kinds."""
        return self.form, self.kinds

    @property
    def places(self) -> dict[Term, int]:
        """The new individuals and their places."""
        return {term: place for place, term in enumerate(self.individuals)}


Shape = tuple[Form | None, tuple[Kind, ...]]


class Runs:
    """Reads runs against a store."""

    def __init__(self, store: Store, kinds: Kinds) -> None:
        self._store = store
        self._kinds = kinds
        self._known: dict[Tokens, Form] = {}
        self._beginning: dict[Term, tuple[Form, ...]] = {}

    def of(self, triples: Sequence[Triple], start: int, stop: int) -> Iterator[Run]:
        """Yield the runs from `start`. Each is read against the current state of the store."""
        while start < stop:
            run = self._read_known_form(triples, start) or self._read(triples, start)
            yield run
            start += len(run.triples)

    def _read_known_form(self, triples: Sequence[Triple], start: int) -> Run | None:
        """Return the run at `start` if it has a known form."""
        for form in self._candidate_forms(triples[start]):
            end = start + form.length
            here = triples[start:end]
            terms = form.terms_of(here)
            parts = None if terms is None else form.parts(terms, form.classes)
            if parts is None or (end < len(triples) and triples[end][0] in parts[0]):
                continue
            if self.are_new(parts[0]) and (kinds := self.kinds_of(parts[1])) is not None:
                return Run(form, here, *parts, kinds)
        return None

    def guess(self, triples: Sequence[Triple], start: int) -> tuple[Form, Terms] | None:
        """Return the form of the run at `start` by its predicates, with its terms.

        A form may be the beginning of a longer one. It only matches if the run does not continue.
        """
        for form in self._candidate_forms(triples[start]):
            end = start + form.length
            terms = form.terms_of(triples[start:end])
            if terms is not None and (end >= len(triples) or triples[end][0] not in terms):
                return form, terms
        return None

    def _candidate_forms(self, triple: Triple) -> tuple[Form, ...]:
        """Return the forms of runs that may start with a triple, the most likely first."""
        s, p, o = triple
        return () if s in self._store.numbers else self._beginning.get(_beginning(p, o), ())

    def are_new(self, names: Sequence[Term]) -> bool:
        """Return whether names are distinct new individuals."""
        is_known = not self._store.numbers.keys().isdisjoint(names)
        return not is_known and len(set(names)) == len(names) and _QUOTE not in set(map(_FIRST, names))

    def _read(self, triples: Sequence[Triple], start: int) -> Run:
        """Read the run at `start` term by term."""
        numbers = self._store.numbers
        first = triples[start][0]
        places: dict[Term, int] = {first: 0}
        others: list[Term] = []
        tokens: list[tuple[int, Term, int | Term | None]] = []
        for at in range(start, len(triples)):
            s, p, o = triples[at]
            subject = places.get(s)
            if subject is None:
                break
            if p == TYPE:
                tokens.append((subject, p, o))
            elif o in numbers or is_literal(o):
                tokens.append((subject, p, None))
                others.append(o)
            else:
                tokens.append((subject, p, places.setdefault(o, len(places))))
        run = triples[start : start + len(tokens)]
        if first in numbers or len(tokens) > _LONGEST:
            return Run(None, run, tuple(places), tuple(others), ())
        kinds = self.kinds_of(others)
        if kinds is None:
            raise LookupError("an object of a run is neither a literal nor known")
        return Run(self._form(tuple(tokens)), run, tuple(places), tuple(others), kinds)

    def kinds_of(self, terms: Iterable[Term]) -> tuple[Kind, ...] | None:
        """Return the kinds of literals and stored individuals; None if there is any other term."""
        numbers, kind, literal = self._store.numbers, self._store.kind, self._kinds.literal
        kinds: list[Kind] = []
        for term in terms:
            node = numbers.get(term)
            if node is not None:
                kinds.append(kind[node])
            elif term[0] == _QUOTE:
                kinds.append(literal(term))
            else:
                return None
        return tuple(kinds)

    def _form(self, tokens: Tokens) -> Form:
        """Return the form of a run, and move it to the front of the candidates."""
        form = self._known.get(tokens)
        if form is None:
            if len(self._known) >= _MOST:
                self._known.clear()
                self._beginning.clear()
            form = self._known[tokens] = Form(tokens)
        tried = self._beginning.get(form.beginning, ())
        self._beginning[form.beginning] = (form, *(other for other in tried if other is not form))[:_TRIED]
        return form


def _beginning(predicate: Term, object_: int | Term | None) -> Term:
    """Return the class or predicate of a run's first triple, which is the same for all runs of a form."""
    return object_ if predicate == TYPE and isinstance(object_, str) else predicate


def _picker(places: Sequence[int]) -> Callable[[tuple[_T, ...]], tuple[_T, ...]]:
    """Return a function that selects some positions of a tuple, as a tuple."""
    if len(places) > 1:
        return itemgetter(*places)
    first = places[0] if places else 0
    return itemgetter(slice(first, first + len(places)))
