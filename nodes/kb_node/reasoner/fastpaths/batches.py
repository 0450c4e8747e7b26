"""Many runs of known forms, one after the other, read together: column by column instead of run by run.

A load is ten thousand times much the same. What takes a dozen steps for each star is here one step for a
column: for all that stands at one place of all runs of a form.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, compress, repeat
from typing import NamedTuple

from nodes.kb_node.reasoner.abox.kinds import Kind
from nodes.kb_node.reasoner.explanations import Term, Triple
from nodes.kb_node.reasoner.fastpaths.runs import Form, Run, Runs, Terms

_MANY = 16
"""Runs that are worth it."""
_MOST = 1000
"""Runs read together; all of them are read singly where one is not so plain."""


class Batch(NamedTuple):
    """Runs of one shape. A column is what one place holds, run by run."""

    form: Form
    kinds: tuple[Kind, ...]
    individuals: Sequence[Terms]
    others: Sequence[Terms]
    triples: Sequence[Sequence[Triple]]

    def runs(self) -> Iterator[Run]:
        """Each by itself."""
        others = zip(*self.others, strict=True) if self.others else repeat(())
        individuals = zip(*self.individuals, strict=True)
        return map(Run, repeat(self.form), self.triples, individuals, others, repeat(self.kinds))

    def of_kinds(self, kinds: tuple[Kind, ...], each: Sequence[tuple[Kind, ...]]) -> Batch:
        """Those whose other objects are of these kinds, where these are the kinds of each."""
        wanted = [of_one == kinds for of_one in each]
        individuals, others = (
            [tuple(compress(column, wanted)) for column in columns]
            for columns in (self.individuals, self.others)
        )
        return Batch(self.form, kinds, individuals, others, list(compress(self.triples, wanted)))


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
    if sum(len(batch.triples) for batch in found) < _MANY:
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
    rows: dict[Form, list[tuple[Terms, Sequence[Triple]]]] = {}
    end = start
    for _ in range(_MOST):
        if end == len(triples) or (guess := runs.guess(triples, end)) is None:
            break
        form, said, here = guess
        rows.setdefault(form, []).append((said, here))
        end += form.length
    found = []
    for form, row in rows.items():
        said, here = zip(*row, strict=True)
        classes = [(cls,) * len(row) for cls in form.classes]
        parts = form.parts(tuple(zip(*said, strict=True)), tuple(classes))
        if parts is None:
            return [], end
        found.append(Batch(form, (), *parts, here))
    return found, end


def _by_shape(batch: Batch, kind_of: dict[Term, Kind]) -> Iterable[Batch]:
    if not batch.others:
        return [batch]
    columns = [map(kind_of.__getitem__, column) for column in batch.others]
    each = list(zip(*columns, strict=True))
    shapes = dict.fromkeys(each)
    if len(shapes) == 1:
        return [batch._replace(kinds=each[0])]
    return [batch.of_kinds(kinds, each) for kinds in shapes]
