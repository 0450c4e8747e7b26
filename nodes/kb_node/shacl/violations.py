"""Violations of SHACL shapes in words."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, NamedTuple, cast

from msgspec import structs

from semmap.nodes.kb_node.map_state import MapState
from semmap.nodes.kb_node.reasoner import GivenFacts, Reasoner
from semmap.nodes.kb_node.shacl.results import Result
from semmap.nodes.kb_node.shacl.shape_triples import PATTERNS_OF_SHAPES, find_shapes
from semmap.nodes.kb_node.shacl.validation_process import ShapeValidator, not_evaluated
from semmap.ontology import vocabulary as v
from semmap.schemas import errors, wording
from semmap.schemas.commands import SHAPES_BYTES, Check
from semmap.schemas.explanations import Term
from semmap.schemas.replies import Checked, Violation

_STEP: Final = "correct the map or the shape"
_IRI: Final = re.compile(r"<[^<>]*>")


def to_violation(
    result: Result, name_of: Callable[[Term], str], names: Mapping[Term, str], step: str = _STEP
) -> Violation:
    """Return a result for the client.

    `name_of(individual)` returns the name of an individual, and `names` has those of classes and properties
    whose local names are not unique. `step` is the next step, unless the shape has a message.
    """

    def words(term: Term) -> str:
        if term.startswith('"'):
            return v.lexical(term)
        return "an individual without a name" if term.startswith("_:") else names.get(term) or name_of(term)

    path = _IRI.sub(lambda found: names.get(found[0]) or v.local_name(found[0]), result.path)
    value = words(result.value) if result.value and result.value != result.focus else ""
    name = words(result.focus)
    shape = "" if result.shape.startswith("_:") else v.local_name(result.shape)
    message, details = result.message, [path, value]
    if not message:
        values = f"the value {value} of {path} violates" if value else f"the values of {path} violate"
        message = f"{values if path else f'{value} violates' if value else 'violates'} {result.constraint}"
        details = [f"{step} {shape}".strip()] if step else []
    return Violation(
        name=name,
        message=message,
        path=path,
        value=value,
        severity=cast(Any, result.severity),
        shape=shape,
        text="; ".join(filter(None, (f"{name}: {message}", *details))),
    )


def describe_rejection(results: Sequence[Result], map_state: MapState) -> str:
    """Return why a commit is rejected, with the first violation."""

    def name_of(term: Term) -> str:
        entity = map_state.find_by_individual(term)
        return v.entity_name(term) if entity is None else entity.name

    first = to_violation(results[0], name_of, map_state.classes.qualified_names, step="").text
    more = f" (and {wording.counted(len(results) - 1, 'more violation')})" if len(results) > 1 else ""
    return f"{first}{more}; required by the shapes of the TBox (semmap up --enforce-shapes)"


class Names(NamedTuple):
    """The names of a map at one moment, for another thread."""

    individuals: Mapping[Term, str]
    terms: Mapping[Term, str]

    @classmethod
    def of(cls, map_state: MapState) -> Names:
        """Return the names of a map. Equal individuals have the name of their entity."""
        equals = map_state.reasoner.equals
        individuals = {
            one: entity.name
            for entity in map_state.by_name.values()
            for one in equals(v.iri(entity.iri)) or (v.iri(entity.iri),)
        }
        return cls(individuals, map_state.classes.qualified_names)

    def individual(self, term: Term) -> str:
        """Return the name of an individual."""
        return self.individuals.get(term) or v.entity_name(term)


def require_size(query: Check) -> None:
    """Raise BadFile for a document with shapes that is too large."""
    if len(query.shapes) > SHAPES_BYTES:
        name, most = query.filename or "the file", SHAPES_BYTES >> 20
        raise errors.BadFile(f"{name} is larger than {most} MiB; split it into several files")


def has_shapes(query: Check, facts: GivenFacts) -> bool:
    """Return whether a check has shapes to evaluate: those of its document, of the map or of the TBox."""
    return bool(query.shapes or find_shapes(facts.asserted))


def may_have_shapes(query: Check, reasoner: Reasoner) -> bool:
    """Return whether a check has shapes to evaluate, without a look at each fact of the map."""
    return bool(query.shapes) or any(
        next(reasoner.asserted(None, p, o), None) is not None for p, o in PATTERNS_OF_SHAPES
    )


def with_validation(
    checked: Checked, validator: ShapeValidator, query: Check, facts: GivenFacts, names: Names
) -> Checked:
    """Return the result of a check with the violations of SHACL shapes.

    Raises BadFile for a document of the query that is not valid, and Refused if it cannot be validated now.
    Without a document, a note says why shapes of the map were not evaluated.
    """
    if not has_shapes(query, facts):
        return checked
    if not checked.consistent:
        return _without_validation(checked, "the map is inconsistent")
    try:
        validation = validator.validate(facts, query.shapes, query.filename)
    except (errors.BadFile, errors.Refused) as error:
        if query.shapes:
            raise
        return _without_validation(checked, error.text)
    return structs.replace(
        checked,
        conforms=False if validation.count else validation.is_complete or None,
        shapes=validation.shapes,
        violation_count=validation.count,
        violations=tuple(to_violation(one, names.individual, names.terms) for one in validation.results),
        notes=(*checked.notes, *validation.notes),
    )


def _without_validation(checked: Checked, reason: str) -> Checked:
    return structs.replace(checked, conforms=None, notes=(*checked.notes, not_evaluated(reason)))
