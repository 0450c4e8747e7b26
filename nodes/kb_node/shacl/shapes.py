"""SHACL shapes, and the facts that violate them.

pySHACL evaluates the constraints of SHACL Core. Its inference is off, because the facts contain what the
reasoner infers. Targets are found here, so that a commit is validated without a search through the map.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, Final

from pyshacl.errors import ShapeRecursionWarning
from pyshacl.helper.path_helper import shacl_path_to_sparql_path
from pyshacl.pytypes import SHACLExecutor
from pyshacl.shape import Shape
from pyshacl.shapes_graph import ShapesGraph
from rdflib import SH, Graph, Literal, URIRef
from rdflib.term import IdentifiedNode, Node

from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.shacl.fact_graph import fact_graph, representative, to_node, to_term
from semmap.nodes.kb_node.shacl.property_paths import push_inverses
from semmap.nodes.kb_node.shacl.results import Result
from semmap.nodes.kb_node.shacl.shape_triples import select_shapes
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.explanations import Term, Triple

_SEVERITIES: Final = {SH.Warning: "warning", SH.Info: "info"}
_LANGUAGES: Final = (None, "en")
"""The languages of the message that is chosen, the best first."""
_MESSAGE: Final = to_term(SH.message)
_LONGEST_TEXT: Final = 500
"""The maximum number of characters of each text in a result. A document has texts of any length."""
_PROBE: Final = URIRef("urn:semmap:probe")
"""An individual without facts, to try the constraints of a shape."""
_AT_ONCE: Final = 100
"""Individuals that are validated together. pySHACL writes a page of text for each violation."""


class Shapes:
    """The shapes of a document or a TBox."""

    def __init__(self, triples: Iterable[Triple], name: str) -> None:
        """Read shapes. Raises BadFile, with `name` as the subject of its text, for invalid ones."""
        self._name = name
        graph = Graph()
        for s, p, o in push_inverses(select_shapes(triples)):
            graph.add((to_node(s), to_node(p), to_node(_short_message(o) if p == _MESSAGE else o)))
        self._graph = ShapesGraph(graph)
        with self._named_errors():
            self._shapes: list[Shape] = [shape for shape in self._graph.shapes if not shape.deactivated]

    def __len__(self) -> int:
        return sum(1 for shape in self._shapes if any(_target_terms(shape)))

    def require_evaluable(self) -> None:
        """Raise BadFile for shapes that cannot be evaluated, such as those with an invalid sh:pattern."""
        with self._named_errors():
            for shape in self._shapes:
                shape.validate(SHACLExecutor(), Graph(), focus=[_PROBE])

    def validate(
        self,
        reasoner: Reasoner,
        touched: Iterable[Term] | None = None,
        failed: Callable[[str], None] | None = None,
    ) -> list[Result]:
        """Return the violations of all individuals, or of the `touched` ones, in the order of their names.

        `failed` receives an error of each shape that cannot be evaluated on some of them, which are left out.
        Without it, raises BadFile.
        """
        find = representative(reasoner)
        facts, executor = fact_graph(reasoner), SHACLExecutor()
        known = None if touched is None else {find(term) for term in touched}
        found: dict[Result, None] = {}
        for shape in self._shapes:
            terms = _all_targets(shape, reasoner) if known is None else _targets(shape, reasoner, known)
            focus = sorted(set(map(find, terms)))
            error: errors.BadFile | None = None
            for start in range(0, len(focus), _AT_ONCE):
                nodes = [to_node(term) for term in focus[start : start + _AT_ONCE]]
                for some in (nodes, *([node] for node in nodes)):  # one by one after an error
                    try:
                        found.update(dict.fromkeys(self._evaluate(shape, some, facts, executor)))
                    except errors.BadFile as raised:
                        if failed is None:
                            raise
                        error = raised
                        continue
                    if some is nodes:
                        break
            if failed is not None and error is not None:
                failed(error.text)
        return sorted(found, key=lambda one: (one.focus, one.path, one.message, one.constraint, one.value))

    def _evaluate(
        self, shape: Shape, focus: Sequence[IdentifiedNode | Literal], facts: Graph, executor: SHACLExecutor
    ) -> list[Result]:
        with self._named_errors():
            _, reports = shape.validate(executor, facts, focus=focus)
            return [self._read(_by_property(parts)) for _, _, parts in reports]

    @contextmanager
    def _named_errors(self) -> Iterator[None]:
        """Raise BadFile for the errors of pySHACL, which has many kinds of them for invalid shapes."""
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", ShapeRecursionWarning)
                yield
        except MemoryError:
            raise
        except ShapeRecursionWarning:
            raise errors.BadFile(f"{self._name}: invalid SHACL shape: a shape refers to itself") from None
        except Exception as error:
            text = " ".join(str(getattr(error, "message", "") or error).split())
            reason = text or type(error).__name__
            raise errors.BadFile(f"{self._name}: invalid SHACL shape: {reason}") from None

    def _read(self, report: dict[Node, list[Any]]) -> Result:
        source = report[SH.sourceShape][0]
        path = report.get(SH.resultPath, [None])[0]
        value = report.get(SH.value, [None])[0]
        return Result(
            focus=_short_term(report[SH.focusNode][0]),
            message=errors.shortened(self._message(source), _LONGEST_TEXT),
            constraint=errors.shortened(self._constraint(source, report), _LONGEST_TEXT),
            path="" if path is None else errors.shortened(self._path(path), _LONGEST_TEXT),
            value="" if value is None else _short_term(value),
            severity=_SEVERITIES.get(report[SH.resultSeverity][0], "violation"),
            shape=_short_term(source),
        )

    def _message(self, source: Node) -> str:
        own = [text for text in self._graph.graph.objects(source, SH.message) if isinstance(text, Literal)]
        return str(min(own, key=lambda text: (_rank(text.language), str(text)), default=""))

    def _constraint(self, source: Node, report: dict[Node, list[Any]]) -> str:
        component = str(report[SH.sourceConstraintComponent][0])
        name = component.removeprefix(str(SH)).removesuffix("ConstraintComponent")
        parameter = name[:1].lower() + name[1:]
        values = [
            o for o in self._graph.graph.objects(source, SH[parameter]) if isinstance(o, (URIRef, Literal))
        ]
        limit = (
            f" {v.lexical(to_term(values[0]))}" if len(values) == 1 and isinstance(values[0], Literal) else ""
        )
        if len(values) == 1 and isinstance(values[0], URIRef):
            limit = f" {v.local_name(to_term(values[0]))}"
        return f"sh:{parameter}{limit}"

    def _path(self, path: Node) -> str:
        if isinstance(path, URIRef):
            return to_term(path)
        return str(shacl_path_to_sparql_path(self._graph, path, prefixes={}))


def _by_property(parts: Iterable[tuple[Node, Node, Any]]) -> dict[Node, list[Any]]:
    """Return a validation result of pySHACL by property. It writes some nodes as (graph, node)."""
    found: dict[Node, list[Any]] = {}
    for _, predicate, value in parts:
        found.setdefault(predicate, []).append(value[1] if isinstance(value, tuple) else value)
    return found


def _short_message(message: Term) -> Term:
    """Return a message that is not too long for a result."""
    if not message.startswith('"'):
        return message
    text = errors.shortened(v.lexical(message), _LONGEST_TEXT)
    return v.literal(text, lang=v.language_of(message))


def _short_term(node: Node) -> Term:
    """Return the term of a node, with a shorter text if it is too long for a result."""
    term = to_term(node)
    if len(term) <= _LONGEST_TEXT:
        return term
    text = errors.shortened(str(node), _LONGEST_TEXT)
    if isinstance(node, Literal):
        return v.literal(text)
    return v.iri(text) if isinstance(node, URIRef) else f"_:{text}"


def _rank(language: str | None) -> int:
    return _LANGUAGES.index(language) if language in _LANGUAGES else len(_LANGUAGES)


def _all_targets(shape: Shape, reasoner: Reasoner) -> Iterator[Term]:
    nodes, classes, subjects_of, objects_of = _target_terms(shape)
    yield from nodes
    for cls in classes:
        yield from reasoner.instances(cls)
    for p in subjects_of:
        yield from (s for s, _, _ in _holding(reasoner, None, p, None))
    for p in objects_of:
        yield from (o for _, _, o in _holding(reasoner, None, p, None))


def _targets(shape: Shape, reasoner: Reasoner, touched: set[Term]) -> Iterator[Term]:
    """Yield those of `touched` that are targets of the shape."""
    nodes, classes, subjects_of, objects_of = _target_terms(shape)
    for term in touched:
        if (
            term in nodes
            or (classes and not classes.isdisjoint(reasoner.types(term)))
            or any(next(_holding(reasoner, term, p, None), None) for p in subjects_of)
            or any(next(_holding(reasoner, None, p, term), None) for p in objects_of)
        ):
            yield term


def _target_terms(shape: Shape) -> tuple[set[Term], set[Term], set[Term], set[Term]]:
    """Return the nodes, classes, and properties of subjects and of objects that a shape targets."""
    found: tuple[Iterable[Node], ...] = shape.target()  # type: ignore[no-untyped-call]
    nodes, classes, implicit, objects_of, subjects_of = (set(map(to_term, terms)) for terms in found)
    return nodes, classes | implicit, subjects_of, objects_of


def _holding(reasoner: Reasoner, s: Term | None, p: Term | None, o: Term | None) -> Iterator[Triple]:
    yield from reasoner.given(s, p, o)
    yield from reasoner.inferred(s, p, o)
