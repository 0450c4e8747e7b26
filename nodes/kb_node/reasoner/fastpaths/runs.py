"""Triples cut into runs about new individuals, and recognised by their form.

Two runs have one *form* if they differ in nothing but the names of the new individuals, and in which other
individuals and literals these are related to. A run of a form that was met before is recognised as a whole;
any other is read word by word.
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
"""A run without its names, triple by triple: an individual is its place, None is any other object."""
Terms = tuple[Term, ...]
_T = TypeVar("_T")
Parts = tuple[tuple[_T, ...], tuple[_T, ...]]
_QUOTE, _FIRST = '"', itemgetter(0)
_LONGEST = 64
"""Triples of a run that has a form; a home's entities have about twenty."""
_MOST = 2000
"""Forms remembered."""
_TRIED = 8
"""Forms that a run is compared with, of those that begin like it."""


class Form:
    """What is the same in the triples of many runs. One object is one form."""

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
        said = [s for s, _, _ in tokens] + [o for _, _, o in tokens]
        places = sorted({word for word in said if isinstance(word, int)})
        self.classes = tuple(dict.fromkeys(word for word in said if isinstance(word, str)))
        fixed = [at for at, word in enumerate(said) if word is not None]
        known = [*places, *self.classes]
        self._individuals = _picker([said.index(place) for place in places])
        self._fixed = _picker(fixed)
        self._expected = _picker([known.index(said[at]) for at in fixed])
        self._others = _picker([at for at, word in enumerate(said) if word is None])

    def terms_of(self, triples: Sequence[Triple]) -> Terms | None:
        """The subjects, then the objects; None if the predicates are others."""
        subjects, predicates, objects = zip(*triples)  # noqa: B905, it is quicker
        return subjects + objects if predicates == self._predicates else None

    def parts(self, said: tuple[_T, ...], classes: tuple[_T, ...]) -> Parts[_T] | None:
        """The individuals and the other objects of what is `said`; None if it has another form.

        That is of one run, or of many by columns: then the classes are columns, too.
        """
        individuals = self._individuals(said)
        if self._expected(individuals + classes) != self._fixed(said):
            return None
        return individuals, self._others(said)


class Run(NamedTuple):
    """Consecutive triples; all but the first subject were mentioned before."""

    form: Form | None
    """None where a subject is no new individual, or the run is too long."""
    triples: Sequence[Triple]
    individuals: Terms
    """The new individuals."""
    others: Terms
    """The other objects, triple by triple."""
    kinds: tuple[Kind, ...]
    """Those of the other objects."""

    @property
    def shape(self) -> Shape:
        """The form with the kinds."""
        return self.form, self.kinds

    @property
    def places(self) -> dict[Term, int]:
        """The new individuals with their places."""
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
        """The runs that begin there; each is read against the store as it is when the run is asked for."""
        while start < stop:
            run = self._read_known_form(triples, start) or self._read(triples, start)
            yield run
            start += len(run.triples)

    def _read_known_form(self, triples: Sequence[Triple], start: int) -> Run | None:
        """The run that begins there, if it has a known form."""
        for form in self._candidate_forms(triples[start]):
            end = start + form.length
            here = triples[start:end]
            said = form.terms_of(here)
            parts = None if said is None else form.parts(said, form.classes)
            if parts is None or (end < len(triples) and triples[end][0] in parts[0]):
                continue
            if self.are_new(parts[0]) and (kinds := self.kinds_of(parts[1])) is not None:
                return Run(form, here, *parts, kinds)
        return None

    def guess(self, triples: Sequence[Triple], start: int) -> tuple[Form, Terms] | None:
        """The form that the run there has by its predicates, with what it says.

        Of a form that is the beginning of another's there may be more; then it is the other one's run.
        """
        for form in self._candidate_forms(triples[start]):
            end = start + form.length
            said = form.terms_of(triples[start:end])
            if said is not None and (end >= len(triples) or triples[end][0] not in said):
                return form, said
        return None

    def _candidate_forms(self, triple: Triple) -> tuple[Form, ...]:
        """The forms of runs that may begin with a triple, the likeliest first."""
        s, p, o = triple
        return () if s in self._store.numbers else self._beginning.get(_beginning(p, o), ())

    def are_new(self, names: Sequence[Term]) -> bool:
        """Whether they are different individuals, of whom nothing is known."""
        is_known = not self._store.numbers.keys().isdisjoint(names)
        return not is_known and len(set(names)) == len(names) and _QUOTE not in set(map(_FIRST, names))

    def _read(self, triples: Sequence[Triple], start: int) -> Run:
        """The run that begins there, word by word."""
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
            raise LookupError("a run mentions what is neither a literal nor known")
        return Run(self._form(tuple(tokens)), run, tuple(places), tuple(others), kinds)

    def kinds_of(self, terms: Iterable[Term]) -> tuple[Kind, ...] | None:
        """The kinds of literals and of what is in the store; None if there is anything else."""
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
        """The form of a run; the first to be tried from now on."""
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
    """What a run's first triple says of its subject, as far as that is the same in all of its form."""
    return object_ if predicate == TYPE and isinstance(object_, str) else predicate


def _picker(places: Sequence[int]) -> Callable[[tuple[_T, ...]], tuple[_T, ...]]:
    """A function that picks what is at some places of a tuple, as a tuple."""
    if len(places) > 1:
        return itemgetter(*places)
    first = places[0] if places else 0
    return itemgetter(slice(first, first + len(places)))
