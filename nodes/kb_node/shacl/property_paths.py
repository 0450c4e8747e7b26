"""The property paths of SHACL shapes: which facts lead from an individual to what a shape reads about it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from math import inf
from typing import Final, NamedTuple

from semmap.nodes.kb_node.shacl.shape_triples import REFERENCES, SHACL, read_list, select_shapes
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple

_PATH: Final = v.iri(f"{SHACL}path")
_INVERSE: Final = v.iri(f"{SHACL}inversePath")
_ALTERNATIVES: Final = v.iri(f"{SHACL}alternativePath")
_OPTIONAL: Final = v.iri(f"{SHACL}zeroOrOnePath")
_REPEATED: Final = (v.iri(f"{SHACL}zeroOrMorePath"), v.iri(f"{SHACL}oneOrMorePath"))

Facts = Callable[[Term | None, Term | None, Term | None], Iterable[Triple]]


class PropertyPaths(NamedTuple):
    """The steps of all paths of some shapes."""

    forward: frozenset[Term] = frozenset()
    """Properties that are followed from their subjects to their values."""
    inverse: frozenset[Term] = frozenset()
    """Properties that are followed from their values to their subjects."""
    length: float = 0
    """The maximum number of steps from an individual to what a shape reads, nested shapes included. It is
    infinite for a path that repeats."""

    def find_starts(self, terms: Iterable[Term], facts: Facts) -> set[Term]:
        """Return the individuals from which the paths may lead to one of `terms`, and `terms`.

        `facts(s, p, o)` returns the facts of a pattern. All facts of a term are read together, which is
        quicker than by property.
        """
        found = newest = set(terms)
        steps = 0
        while newest and steps < self.length:
            newest = {start for term in newest for start in self._step_back(term, facts)} - found
            found = found | newest
            steps += 1
        return found

    def _step_back(self, term: Term, facts: Facts) -> Iterator[Term]:
        """Yield the individuals from which one step leads to `term`."""
        if self.forward:
            yield from (s for s, p, _ in facts(None, None, term) if p in self.forward)
        if self.inverse:
            found = facts(term, None, None)
            yield from (o for _, p, o in found if p in self.inverse and not o.startswith('"'))


def find_property_paths(tbox: Iterable[Triple]) -> PropertyPaths:
    """Return the steps of the paths of the shapes in a TBox."""
    return _PathReader(select_shapes(tbox)).read()


def push_inverses(triples: Iterable[Triple]) -> list[Triple]:
    """Return the triples of shapes with inverse paths of properties only: `^(a/b)` becomes `^b/^a`.

    pySHACL would follow the steps of an inverse sequence in the wrong order.
    """
    found = list(triples)
    while True:
        about: dict[tuple[Term, Term], Term] = {(s, p): o for s, p, o in found}
        for triple in found:
            if triple[1] == _INVERSE and (pushed := [*_push(triple[0], triple[2], about)]):
                found.remove(triple)
                found += pushed
                break
        else:
            return found


def _push(node: Term, path: Term, about: Mapping[tuple[Term, Term], Term]) -> Iterator[Triple]:
    """Yield the triples of `node` as the inverse of a path; none if that is a property or an inverse."""
    if (path, v.RDF_FIRST) in about:
        yield from _wrap(node, [*read_list(path, about)][::-1])
    elif (parts := about.get((path, _ALTERNATIVES))) is not None:
        yield (node, _ALTERNATIVES, f"{node}a")
        yield from _wrap(f"{node}a", [*read_list(parts, about)])
    else:
        for p in (_OPTIONAL, *_REPEATED):
            if (part := about.get((path, p))) is not None:
                yield from ((node, p, f"{node}i"), (f"{node}i", _INVERSE, part))


def _wrap(node: Term, paths: Sequence[Term]) -> Iterator[Triple]:
    """Yield the list `node` of the inverses of some paths."""
    for n, path in enumerate(paths):
        here, rest = (node if n == 0 else f"{node}r{n}"), f"{node}r{n + 1}"
        yield (here, v.RDF_FIRST, f"{node}i{n}")
        yield (f"{node}i{n}", _INVERSE, path)
        yield (here, v.RDF_REST, rest if n + 1 < len(paths) else v.RDF_NIL)


class _PathReader:
    """Reads the paths from the triples of shapes."""

    def __init__(self, triples: Iterable[Triple]) -> None:
        self._values: dict[tuple[Term, Term], list[Term]] = {}
        self._lists: dict[tuple[Term, Term], Term] = {}
        self._nodes = dict[Term, None]()
        """The subjects of the triples."""
        self._lengths: dict[Term, float] = {}
        """The numbers of steps from an individual of a shape; infinite while they are computed."""
        self._forward = set[Term]()
        self._inverse = set[Term]()
        for s, p, o in triples:
            self._values.setdefault((s, p), []).append(o)
            self._nodes[s] = None
            if p in (v.RDF_FIRST, v.RDF_REST):
                self._lists[s, p] = o

    def read(self) -> PropertyPaths:
        length = max(map(self._length_of_shape, self._nodes), default=0)
        return PropertyPaths(frozenset(self._forward), frozenset(self._inverse), length)

    def _of(self, node: Term, p: Term) -> list[Term]:
        return self._values.get((node, p), [])

    def _length_of_shape(self, shape: Term) -> float:
        """Return the maximum number of steps from an individual of a shape, or of a list of shapes."""
        if (known := self._lengths.get(shape)) is not None:
            return known
        self._lengths[shape] = inf  # for a shape that refers to itself
        own = max((self._length(path, is_inverse=False) for path in self._of(shape, _PATH)), default=0)
        nested = (self._length_of_shape(o) for p in REFERENCES for o in self._of(shape, p))
        length = self._lengths[shape] = own + max(nested, default=0)
        return length

    def _length(self, path: Term, *, is_inverse: bool) -> float:
        """Return the maximum number of steps of a path, and add its properties."""
        if path.startswith("<"):
            (self._inverse if is_inverse else self._forward).add(path)
            return 1
        if self._of(path, v.RDF_FIRST):
            return sum(self._length(part, is_inverse=is_inverse) for part in read_list(path, self._lists))
        lengths = [self._length(part, is_inverse=not is_inverse) for part in self._of(path, _INVERSE)]
        lengths += [self._length(part, is_inverse=is_inverse) for part in self._of(path, _OPTIONAL)]
        for parts in self._of(path, _ALTERNATIVES):
            lengths += [self._length(part, is_inverse=is_inverse) for part in read_list(parts, self._lists)]
        for p in _REPEATED:
            for part in self._of(path, p):
                self._length(part, is_inverse=is_inverse)
                lengths.append(inf)
        return max(lengths, default=0)
