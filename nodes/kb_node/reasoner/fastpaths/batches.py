"""Many runs of known forms, one after the other, read together: column by column instead of run by run.

A load is ten thousand times much the same. What takes a dozen steps for each star is here one step for a
column: for all that stands at one place of all runs of a form.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain, compress
from typing import NamedTuple

from semmap.nodes.kb_node.reasoner.abox.kinds import Kind
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.fastpaths.runs import Form, Runs, Terms

_MANY = 16
"""Runs that are worth it."""
_MOST = 2000
"""Runs read together; all of them are read singly where one is not so plain."""


class Batch(NamedTuple):
    """Runs of one shape. A column is what one place holds, run by run."""

    form: Form
    kinds: tuple[Kind, ...]
    individuals: Sequence[Terms]
    others: Sequence[Terms]

    @property
    def size(self) -> int:
        """How many they are."""
        return len(self.individuals[0])

    def where(self, wanted: Sequence[bool]) -> Batch:
        """Some of them."""
        individuals, others = (
            [tuple(compress(column, wanted)) for column in columns]
            for columns in (self.individuals, self.others)
        )
        return self._replace(individuals=individuals, others=others)


class Batches(NamedTuple):
    """Runs that follow one another, by shape."""

    of_shape: Sequence[Batch]
    kind_of: dict[Term, Kind]
    """Of each of their other objects."""


def batches(runs: Runs, triples: Sequence[Triple], start: int) -> tuple[Batches | None, int]:
    """The runs of known forms that begin there, and where they end.

    None where they are few, or one of them is about an individual that is known or in another of them.
    """
    found, end = _by_form(runs, triples, start)
    if sum(batch.size for batch in found) < _MANY:
        return None, end
    names = list(chain.from_iterable(column for batch in found for column in batch.individuals))
    terms = set[Term]().union(*(column for batch in found for column in batch.others))
    kinds = runs.kinds_of(terms) if runs.are_new(names) else None
    if kinds is None:
        return None, end
    kind_of = dict(zip(terms, kinds, strict=True))
    return Batches([shape for batch in found for shape in _by_shape(batch, kind_of)], kind_of), end


def _by_form(runs: Runs, triples: Sequence[Triple], start: int) -> tuple[list[Batch], int]:
    """The runs of each form, of no kinds yet; none where one has another form than its predicates promise."""
    rows: dict[Form, list[Terms]] = {}
    end = start
    for _ in range(_MOST):
        if end == len(triples) or (guess := runs.guess(triples, end)) is None:
            break
        form, said = guess
        rows.setdefault(form, []).append(said)
        end += form.length
    found = []
    for form, row in rows.items():
        classes = [(cls,) * len(row) for cls in form.classes]
        parts = form.parts(tuple(zip(*row, strict=True)), tuple(classes))
        if parts is None:
            return [], end
        found.append(Batch(form, (), *parts))
    return found, end


def _by_shape(batch: Batch, kind_of: dict[Term, Kind]) -> Iterable[Batch]:
    if not batch.others:
        return [batch]
    columns = [map(kind_of.__getitem__, column) for column in batch.others]
    each = list(zip(*columns, strict=True))
    shapes = dict.fromkeys(each)
    if len(shapes) == 1:
        return [batch._replace(kinds=each[0])]
    return [batch.where([of == kinds for of in each])._replace(kinds=kinds) for kinds in shapes]
