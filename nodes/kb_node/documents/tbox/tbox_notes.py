"""Notes on a TBox for the operator. They are shown once."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterable
from contextlib import suppress

from semmap.nodes.kb_node.documents import ontology_files, rdf
from semmap.nodes.kb_node.documents.inert_statements import count_inert, inert_note
from semmap.nodes.kb_node.documents.rule_terms import undeclared_note, undeclared_terms
from semmap.nodes.kb_node.documents.tbox import tbox_validation
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.tbox.profile import outside_rl
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.nodes.kb_node.relations.facts.rules import COMPUTED
from semmap.ontology import HOUSEHOLD_TTL
from semmap.ontology import vocabulary as v
from semmap.schemas import wording
from semmap.schemas.explanations import Triple

_FEW = 5
_SOMETHING = ("<urn:semmap:something>", v.RDF_TYPE, v.OWL_THING)


def notes(tbox: Iterable[Triple], reasoner: Reasoner, classes: ClassTable) -> tuple[str, ...]:
    """Return notes on what is missing, ineffective or slow.

    Ineffective axioms of the shipped TBox are not reported.
    """
    tbox = list(tbox)
    texts = (
        missing_imports_note(ontology_files.missing_imports(tbox)),
        no_spatial_class_note(classes),
        ignored_statements_note(tbox),
        beyond_rl_note(outside_rl(filter(is_schema, tbox)) - _known(tbox)),
        inert_note(count_inert(tbox)),
        undeclared_note(undeclared_terms(tbox)),
        described_entities_note(tbox_validation.described_by(tbox, classes)),
        slow_changes_note(reasoner),
        no_spatial_facts_note(reasoner, classes),
    )
    return tuple(filter(None, texts))


def _known(tbox: Iterable[Triple]) -> Counter[str]:
    """Return the axioms beyond OWL 2 RL of the shipped TBox, if this TBox is based on it."""
    if v.TBOX_ONTOLOGY not in ontology_files.header(tbox).ontologies:
        return Counter()
    return outside_rl(filter(is_schema, rdf.parse(HOUSEHOLD_TTL.read_bytes(), HOUSEHOLD_TTL.name)))


def missing_imports_note(imports: tuple[str, ...]) -> str:
    """Return a note on missing imports, or ""."""
    if not imports:
        return ""
    few = " and ".join(filter(None, (", ".join(imports[:_FEW]), _more(len(imports) - _FEW))))
    return f"{_count(len(imports), 'import')} not found; the TBox is used without: {few}"


def no_spatial_facts_note(reasoner: Reasoner, classes: ClassTable) -> str:
    """Return a note if no spatial facts are computed because the TBox lacks the properties, or ""."""
    if not classes.spatial or any(any(reasoner.asserted(p, v.RDF_TYPE, None)) for p in COMPUTED):
        return ""
    few = ", ".join(sorted(COMPUTED.values()))
    return f"the TBox has none of {few}, so spatial relations are measured on request and are not facts"


def no_spatial_class_note(classes: ClassTable) -> str:
    """Return a note if the TBox has no spatial class, or ""."""
    if classes.spatial:
        return ""
    return (
        "the TBox has no spatial class, so entities cannot be added; load it again with --spatial-root CLASS"
    )


def ignored_statements_note(tbox: Iterable[Triple]) -> str:
    """Return a note on statements of the TBox that are ignored, or ""."""
    reasons: dict[str, list[str]] = {}
    for s, text in sorted((v.local_name(s), v.lexical(o)) for s, p, o in tbox if p == v.SET_ASIDE):
        what, _, why = text.partition(": ")
        reasons.setdefault(why, []).append(f"{s} {what}")
    texts = "; ".join(f"{', '.join(what)} ({why})" for why, what in reasons.items())
    return texts and f"ignored, because every map would be inconsistent with it: {texts}"


def beyond_rl_note(kinds: Counter[str]) -> str:
    """Return a note on the axioms that the reasoner does not use fully, by kind, or ""."""
    if not kinds:
        return ""
    most = sorted(kinds.items(), key=lambda kind: (-kind[1], kind[0]))[:_FEW]
    few = ", ".join(f"{count} x {kind}" for kind, count in most)
    if others := kinds.total() - sum(count for _, count in most):
        few += f", {others} of other kinds"
    axioms = "1 axiom goes" if kinds.total() == 1 else f"{kinds.total()} axioms go"
    return f"{axioms} beyond OWL 2 RL; that part has no effect ({few})"


def described_entities_note(names: list[str]) -> str:
    """Return a note on entities that no command can change, or ""."""
    if not names:
        return ""
    are = f"{wording.entities(len(names))} {'is' if len(names) == 1 else 'are'}"
    return f"{are} described by the TBox itself, so commands cannot change them: {wording.few(names, 4)}"


def slow_changes_note(reasoner: Reasoner) -> str:
    """Return a note on why the reasoner is not incremental, and the time of a change, or ""."""
    if (why := reasoner.not_incremental) is None:
        return ""
    began_s = time.perf_counter()
    with suppress(Inconsistent):
        reasoner.apply(insert=[_SOMETHING])
        reasoner.apply(delete=[_SOMETHING])
    each_ms = (time.perf_counter() - began_s) / 2 * 1e3
    return f"not incremental: {why}, about {each_ms:.0f} ms a change"


def _more(count: int) -> str:
    return f"{count} more" if count > 0 else ""


def _count(number: int, what: str) -> str:
    return f"1 {what} was" if number == 1 else f"{number} {what}s were"
