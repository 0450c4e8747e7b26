"""Consecutive runs of known forms, read together: column by column instead of run by run.

A load has thousands of entities of the same form. Instead of a dozen steps for each entity, one step
processes a column: the terms at one position of all runs of a form.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain, compress
from typing import NamedTuple

from semmap.nodes.kb_node.reasoner.abox.kinds import Kind
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.fastpaths.runs import Form, Runs, Terms

_MANY = 16
"""Minimum number of runs for a batch."""
_MOST = 2000
"""Maximum number of runs in a batch. All of them are read singly if one of them is irregular."""


class Batch(NamedTuple):
    """Runs of one shape. A column has the terms at one position of each run."""

    form: Form
    kinds: tuple[Kind, ...]
    individuals: Sequence[Terms]
    others: Sequence[Terms]

    @property
    def size(self) -> int:
        """The number of runs."""
        return len(self.individuals[0])

    def select(self, wanted: Sequence[bool]) -> Batch:
        """Return the runs selected by `wanted`."""
        individuals, others = (
            [tuple(compress(column, wanted)) for column in columns]
            for columns in (self.individuals, self.others)
        )
        return self._replace(individuals=individuals, others=others)


class Batches(NamedTuple):
    """Consecutive runs by shape."""

    of_shape: Sequence[Batch]
    kind_of: dict[Term, Kind]
    """The kinds of their other objects."""


def read_batches(runs: Runs, triples: Sequence[Triple], start: int) -> tuple[Batches | None, int]:
    """Return the consecutive runs of known forms from `start`, and the position of their end.

    Returns None instead of the runs if they are few, or if an individual is known or occurs in two runs.
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
    """Return the runs of each form, without kinds; none if a run does not have the form of its predicates."""
    rows: dict[Form, list[Terms]] = {}
    end = start
    for _ in range(_MOST):
        if end == len(triples) or (guess := runs.guess(triples, end)) is None:
            break
        form, terms = guess
        rows.setdefault(form, []).append(terms)
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
    return [batch.select([of == kinds for of in each])._replace(kinds=kinds) for kinds in shapes]
