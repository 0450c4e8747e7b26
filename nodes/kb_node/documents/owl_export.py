"""Writes a map in OWL's functional or Manchester syntax, by py-horned-owl.

It converts RDF/XML to axioms, and drops triples that are not part of an axiom, such as those of RDF lists and
of reified statements. The result is read again, so that their number is known.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Final, Literal

import pyhornedowl
from msgspec import Struct

from semmap.nodes.kb_node.documents import language_tags, rdf
from semmap.nodes.kb_node.documents.owl import syntaxes
from semmap.ontology import vocabulary as v
from semmap.schemas import errors, wording
from semmap.schemas.explanations import Term, Triple

OwlFormat = Literal["functional", "manchester"]

_HORNED: Final[dict[OwlFormat, Literal["ofn", "omn"]]] = {"functional": "ofn", "manchester": "omn"}
_FEW: Final = 5
_NODE: Final = "urn:semmap:blank:"
"""The namespace of nameless individuals during the conversion, which drops blank nodes."""
_NAMED_NODE: Final = re.compile(rf"<{_NODE}([^>]*)>")
_BUILT_IN: Final = (f"<{v.OWL}", f"<{v.RDF}", "<http://www.w3.org/2003/11/swrl#")
_EQUALITY: Final = frozenset((v.OWL_SAME_AS, v.iri(f"{v.OWL}differentFrom")))
_UNSPECIFIC: Final = frozenset((v.OWL_THING, v.OWL_NAMED_INDIVIDUAL))
_BETWEEN_CLASSES: Final = frozenset(
    (v.RDFS_SUB_CLASS_OF, v.iri(f"{v.OWL}equivalentClass"), v.iri(f"{v.OWL}disjointWith"))
)
_MEMBERS: Final = {v.iri(f"{v.OWL}distinctMembers"): v.iri(f"{v.OWL}members")}
_ANNOTATION: Final = v.iri(f"{v.OWL}AnnotationProperty")
_LOCAL: Final = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*")


class OwlDocument(Struct, frozen=True):
    """A document, and how many triples it does not state."""

    content: bytes
    lost: int = 0
    notes: tuple[str, ...] = ()


def declarations(triples: Iterable[Triple], known: Iterable[Triple]) -> set[Triple]:
    """Return the declarations of the classes, properties and datatypes that `triples` use.

    `known` includes the TBox. Properties that it does not declare, such as `skos:altLabel`, are annotations.
    Without a declaration, the kind of a property would be guessed by its values.
    """
    triples = list(triples)
    used = {term for triple in triples for term in triple}
    kinds = {*v.PROPERTY_KINDS, v.OWL_CLASS, v.iri(f"{v.RDFS}Datatype")} - {v.iri(f"{v.RDF}Property")}
    declared = {t for t in known if t[1] == v.RDF_TYPE and t[2] in kinds and t[0] in used}
    classes = {term for s, p, o in triples if p in _BETWEEN_CLASSES for term in (s, o) if term[0] == "<"}
    own = {(c, v.RDF_TYPE, v.OWL_CLASS) for c in classes if not c.startswith(_BUILT_IN)}
    properties = {p for _, p, _ in triples if not p.startswith((*_BUILT_IN, f"<{v.RDFS}"))} - {
        s for s, _, _ in declared
    }
    return declared | own | {(p, v.RDF_TYPE, _ANNOTATION) for p in properties}


def write(triples: Iterable[Triple], syntax: OwlFormat, prefixes: Mapping[str, str]) -> OwlDocument:
    """Return an ontology with the axioms of these triples.

    Blank nodes are written as anonymous individuals. Raises Refused for axioms that cannot be converted.
    """
    triples = [t for t in triples if not (t[0].startswith("_:") and t[2] == v.OWL_NAMED_INDIVIDUAL)]
    xml = rdf.serialise(_name_individuals(triples), "rdfxml").decode()
    try:
        ontology = pyhornedowl.open_ontology_from_string(xml, serialization="rdf")
    except ValueError as error:
        reason = " ".join(str(error).removeprefix("Failed to open ontology: ").split())
        raise errors.Refused(
            f"OWL cannot express the map: {reason[:200]}; export as Turtle instead"
        ) from None
    text = ontology.save_to_string(_HORNED[syntax])
    for name, namespace in prefixes.items():
        used = re.findall(rf"<{re.escape(namespace)}([^>]*)>", text)
        if name and used and all(map(_LOCAL.fullmatch, used)):
            ontology.add_prefix_mapping(name, namespace)
    text = _NAMED_NODE.sub(r"_:\1", ontology.save_to_string(_HORNED[syntax]))
    try:
        kept = (t for t in triples if t[1:] != (v.RDF_TYPE, v.OWL_ONTOLOGY))  # a document is one ontology
        lost = Counter(map(_comparable, kept)) - Counter(map(_comparable, syntaxes.parse(text, syntax)))
    except ValueError as error:
        raise errors.Refused(f"{syntax} syntax cannot express the map: {error}; export as Turtle") from None
    return OwlDocument(
        language_tags.restore_case(text.encode(), syntax), lost.total(), tuple(_describe_loss(lost))
    )


def _name_individuals(triples: Iterable[Triple]) -> list[Triple]:
    """Return the triples with IRIs for blank nodes that are individuals, not parts of axioms."""
    triples = list(triples)
    structure = {s for s, p, o in triples if s.startswith("_:") and _is_structure(p, o)}

    def name(term: Term) -> Term:
        return f"<{_NODE}{term[2:]}>" if term.startswith("_:") and term not in structure else term

    return [(name(s), p, name(o)) for s, p, o in triples]


def _is_structure(p: Term, o: Term) -> bool:
    """Return whether a triple describes a part of an axiom."""
    if p == v.RDF_TYPE:
        return o.startswith(_BUILT_IN) and o not in _UNSPECIFIC
    return p.startswith(_BUILT_IN) and p not in _EQUALITY


def _comparable(triple: Triple) -> Triple:
    """Return a triple without the labels of its blank nodes."""
    s, p, o = triple
    return ("_:" if s.startswith("_:") else s, _MEMBERS.get(p, p), "_:" if o.startswith("_:") else o)


def _describe_loss(lost: Counter[Triple]) -> Iterable[str]:
    """Yield a note on the triples that are not in the document."""
    if lost:
        kinds = Counter(v.local_name(p) for _, p, _ in lost.elements())
        most = sorted(kinds.items(), key=lambda kind: (-kind[1], kind[0]))
        few = wording.few([f"{name}: {count}" for name, count in most], _FEW)
        yield f"left out: {wording.counted(lost.total(), 'triple')} that OWL cannot express ({few})"
