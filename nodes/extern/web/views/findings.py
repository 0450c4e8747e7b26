"""Problems of the map: contradictions, violations of shapes, suppressed facts, doubts, faults of bodies."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator
from typing import Final, Literal, NamedTuple

from semmap.nodes.extern.web.views.proof_lines import BASIS_LABELS, Line, proof_lines, words_of
from semmap.schemas import wording
from semmap.schemas.entities import ClassInfo, Entity
from semmap.schemas.explanations import Explanation
from semmap.schemas.replies import Checked

Kind = Literal["contradiction", "violation", "unchecked", "suppressed", "denied", "doubt", "body", "crowd"]

TITLES: Final[dict[Kind, str]] = {
    "contradiction": "Contradiction",
    "violation": "Violation of a SHACL shape",
    "unchecked": "Not checked",
    "suppressed": "Suppressed fact",
    "denied": "Asserted fact that contradicts the geometry",
    "doubt": "Uncertain",
    "body": "Problem with the body",
    "crowd": "Too many objects in one place",
}
MIN_CONFIDENCE: Final = 0.5
"""Entities with a lower confidence are reported."""
NBSP: Final = "\u00a0"
_WORD: Final = re.compile(r"[^\W\d][\w.\-]*")


class Finding(NamedTuple):
    """One problem, with the names of its entities and the lines of its proof."""

    kind: Kind
    text: str
    names: tuple[str, ...]
    proof: tuple[str, ...] = ()


def collect_findings(
    checked: Checked, entities: Iterable[Entity], classes: Iterable[ClassInfo] = ()
) -> tuple[Finding, ...]:
    """Return all problems, the most severe first."""
    known = {entity.name: entity for entity in entities}
    return (*_of_check(checked, known, classes), *_of_entities(known.values()))


def format_verdict(checked: Checked) -> str:
    """Return the verdict in one sentence, with the time of the check and the result of the SHACL shapes."""
    took = f"{1000.0 * checked.elapsed_s:.0f} ms" if checked.elapsed_s < 1.0 else f"{checked.elapsed_s:.1f} s"
    verdict = f"{checked.text} ({checked.triples:,} triples, {took}, {checked.engine})"
    if not checked.shapes:
        return verdict
    found = (
        wording.counted(checked.violation_count, "violation") if checked.violation_count else "no violations"
    )
    return f"{verdict}; {wording.counted(checked.shapes, 'SHACL shape')}: {found}"


def is_sound(checked: Checked) -> bool:
    """Return whether the map is consistent, and no shape is violated or was not evaluated."""
    return checked.consistent and checked.conforms is True


def names_in(text: str, known: Collection[str]) -> tuple[str, ...]:
    """Return the names of entities in a sentence, in order, each once."""
    words = (match[0].rstrip(".-") for match in _WORD.finditer(text))
    return tuple(dict.fromkeys(word for word in words if word in known))


def _of_check(checked: Checked, known: Collection[str], classes: Iterable[ClassInfo]) -> Iterator[Finding]:
    if not checked.consistent:
        explained = checked.explanation
        text = checked.text if explained is None else explained.text
        yield Finding(
            "contradiction", text, names_in(text, known), () if explained is None else format_proof(explained)
        )
    for violation in checked.violations:
        kind = "" if violation.severity == "violation" else f"{violation.severity}: "
        about = dict.fromkeys((violation.name, violation.value))
        yield Finding("violation", f"{kind}{violation.text}", tuple(name for name in about if name in known))
    for text in checked.notes:
        yield Finding("unchecked", text, ())
    for text in checked.withheld:
        yield Finding("suppressed", text, names_in(text, known))
    for relation in checked.denied:
        ends = (relation.subject, relation.object, relation.and_object or "")
        yield Finding("denied", relation.text, tuple(name for name in ends if name in known))
    for text in checked.crowds:
        yield Finding("crowd", text, names_in(text, known))


def _of_entities(entities: Iterable[Entity]) -> Iterator[Finding]:
    bodies: list[Finding] = []
    for entity in sorted(entities, key=lambda e: e.name):
        if entity.conflict:
            yield Finding("doubt", f"{entity.name}: perception detects {entity.conflict}", (entity.name,))
        confidence = entity.provenance.confidence
        if confidence is not None and confidence < MIN_CONFIDENCE:
            text = f"{entity.name}: low confidence ({confidence:.0%}, source {entity.provenance.source})"
            yield Finding("doubt", text, (entity.name,))
        body = entity.body
        if body is not None and body.status in ("ghost", "failed", "missing"):
            reason = f": {body.detail}" if body.detail else _DEFAULT_REASON.get(body.status, "")
            bodies.append(Finding("body", f"{entity.name} {_BODY[body.status]}{reason}", (entity.name,)))
    yield from bodies


_BODY: Final = {
    "ghost": "has a non-colliding body",
    "failed": "has no body, because it could not be created",
    "missing": "has no body",
}
_DEFAULT_REASON: Final = {"ghost": ", because another body occupies its place"}
"""Reasons for a body state without a detail."""


def format_proof(explanation: Explanation, classes: Iterable[ClassInfo] = ()) -> tuple[str, ...]:
    """Return the lines of the proof, with the premises of each conclusion indented below it."""
    words = words_of(classes, ())
    return tuple(
        f"{2 * line.depth * NBSP}{line.text} ({_basis_text(line)})"
        for line in proof_lines(explanation, words)
    )


def _basis_text(line: Line) -> str:
    return f"inferred: {line.rule}" if line.basis == "inferred" and line.rule else BASIS_LABELS[line.basis]
