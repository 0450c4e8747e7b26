"""The IRIs that the code uses, and RDF terms as text.

A term is written as in N-Triples: `<iri>`, `_:label`, `"text"`, `"text"@en`, `"1.0"^^<datatype>`. Literals
made here are canonical (the form that Oxigraph prints), so equal literals are equal strings.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache
from typing import Final
from urllib.parse import unquote

from semmap.schemas.entities import composed, name_of_text
from semmap.schemas.explanations import Term, Triple

TBOX: Final = "http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_domain_model#"
ABOX: Final = "http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_1#"
RDF: Final = "http://www.w3.org/1999/02/22-rdf-syntax-ns#"
RDFS: Final = "http://www.w3.org/2000/01/rdf-schema#"
OWL: Final = "http://www.w3.org/2002/07/owl#"
XSD: Final = "http://www.w3.org/2001/XMLSchema#"

PREFIXES: Final = {"dm": TBOX, "": ABOX, "owl": OWL, "xsd": XSD}
"""The prefixes in written documents."""

TBOX_ONTOLOGY: Final[Term] = f"<{TBOX.removesuffix('#')}>"
ABOX_ONTOLOGY: Final[Term] = f"<{ABOX.removesuffix('#')}>"


def iri(text: str) -> Term:
    """Return the IRI term of a full IRI."""
    return f"<{text}>"


def dm(local: str) -> Term:
    """Return the IRI term of a class, property or individual of the TBox: `dm("Chair")`."""
    return f"<{TBOX}{local}>"


def entity_iri(name: str) -> Term:
    """Return the IRI term of the entity, place, position, size or label with this name in the ABox."""
    return f"<{ABOX}{name}>"


def bare(term: Term) -> str:
    """Return the IRI of an IRI term, without its brackets."""
    return term[1:-1]


def local_name(term: Term) -> str:
    """Return the part after the last `#`, or else `/` or `:`, of an IRI term; other terms unchanged."""
    if not term.startswith("<"):
        return term
    text = term[1:-1]
    return text.rpartition("#" if "#" in text else "/" if "/" in text else ":")[2]


def last_part(term: Term) -> str:
    """Return the local name of an IRI term, or the part before its end if it ends with `/`, `#` or `:`."""
    if name := local_name(term):
        return name
    text = bare(term)
    within = text.rstrip("/#:")
    return text[len(within) - len(local_name(iri(within))) :]


_GIVEN: Final[dict[Term, str]] = {}
"""The names of individuals whose IRI's last part is the name of another one.

They are kept for the process, because names are printed and looked up where only IRIs are at hand.
"""


def give_name(term: Term, name: str) -> None:
    """Set the name of an individual of which the map states it; without a name, that of its IRI counts."""
    if name and name != own_name(term):
        _GIVEN[term] = name
    else:
        _GIVEN.pop(term, None)


def has_given_name(term: Term) -> bool:
    """Return whether an individual has another name than that of its IRI."""
    return term in _GIVEN


def entity_name(term: Term) -> str:
    """Return the name of an individual: the one that the map gives it, or else that of its IRI."""
    if _GIVEN and (given := _GIVEN.get(term)) is not None:
        return given
    return own_name(term)


def own_name(term: Term) -> str:
    """Return the name that an IRI stands for: its last part, without percent escapes.

    If that is not a valid name, `name_of_text` makes one from it. Other terms are returned as text.
    """
    name = local_name(term)
    if name.isidentifier() and name.isascii() and len(name) <= _LONG:
        return name  # as most are
    return _other_name(term) if term.startswith("<") else composed(unquote(term))


@lru_cache(maxsize=1 << 16)
def _other_name(term: Term) -> str:
    """Return the name that an IRI term stands for; cached, as a map may have very many such names."""
    return name_of_text(_unescaped(last_part(term)))


def _unescaped(name: str) -> str:
    """Return a part of an IRI without percent escapes, or unchanged if these are not text."""
    try:
        return unquote(name, errors="strict") if "%" in name else name
    except UnicodeDecodeError:
        return name


_LONG: Final = 128
_ESCAPES: Final = {"\t": "\\t", "\b": "\\b", "\n": "\\n", "\r": "\\r", "\f": "\\f", '"': '\\"', "\\": "\\\\"}
_UNESCAPES: Final = {escape[1]: char for char, escape in _ESCAPES.items()} | {"'": "'"}
_TO_ESCAPE: Final = re.compile(r'[\x00-\x1f\x7f\ufffe\uffff"\\]')
_ESCAPED: Final = re.compile(r"\\(?:u([0-9A-Fa-f]{4})|U([0-9A-Fa-f]{8})|(.))", re.DOTALL)
_LITERAL: Final = re.compile(r'"((?:[^"\\]|\\.)*)"(?:\^\^<([^>]*)>|@([A-Za-z0-9-]+))?', re.DOTALL)


def literal(text: str, datatype: Term | None = None, lang: str | None = None) -> Term:
    """Return the literal term of a text, with a datatype (an IRI term) or a language, or a plain string.

    Raises:
        ValueError: both a datatype and a language are given.
    """
    if datatype is not None and lang is not None:
        raise ValueError("a literal has a datatype or a language, not both")
    quoted = '"' + _TO_ESCAPE.sub(_escape, text) + '"'
    if lang is not None:
        return f"{quoted}@{lang.lower()}"
    return quoted if datatype in (None, XSD_STRING) else f"{quoted}^^{datatype}"


def lexical(term: Term) -> str:
    """Return the text of a literal term, without its datatype or language.

    Raises:
        ValueError: the term is not a literal, or has an escape that N-Triples does not know.
    """
    if term[-1:] == '"' and "\\" not in term and term.count('"') == 2 and term[0] == '"':
        return term[1:-1]  # most are this plain
    return _parts(term)[0]


def to_words(triple: Triple, names: Mapping[Term, str] | None = None) -> str:
    """Return a readable triple with the names of individuals; `names` disambiguates equal local names."""
    apart = names or {}
    s, p, o = triple
    value = local_name(o) if p == RDF_TYPE else entity_name(o)
    return " ".join(
        (
            apart.get(s) or entity_name(s),
            apart.get(p) or local_name(p),
            lexical(o) if o.startswith('"') else apart.get(o) or value,
        )
    )


def datatype_of(term: Term) -> Term:
    """Return the datatype of a literal term as an IRI term.

    Raises:
        ValueError: the term is not a literal.
    """
    _, datatype, lang = _parts(term)
    if lang is not None:
        return RDF_LANG_STRING
    return XSD_STRING if datatype is None else datatype


def language_of(term: Term) -> str | None:
    """Return the language of a literal term in lower case, or None.

    Raises:
        ValueError: the term is not a literal.
    """
    return _parts(term)[2]


def _parts(term: Term) -> tuple[str, Term | None, str | None]:
    match = _LITERAL.fullmatch(term)
    if match is None:
        raise ValueError(f"not a literal: {term}")
    quoted, datatype, lang = match.groups()
    text = _ESCAPED.sub(_unescape, quoted) if "\\" in quoted else quoted
    return text, None if datatype is None else f"<{datatype}>", None if lang is None else lang.lower()


def _escape(match: re.Match[str]) -> str:
    char = match[0]
    return _ESCAPES.get(char) or f"\\u{ord(char):04X}"


def _unescape(match: re.Match[str]) -> str:
    short, long, char = match.groups()
    if char is None:
        return chr(int(short or long, 16))
    if char not in _UNESCAPES:
        raise ValueError(f"unknown escape \\{char} in a literal")
    return _UNESCAPES[char]


# ---- The TBox ----

ABSTRACT_THING: Final = dm("Abstract_Thing")
PHYSICAL_THING: Final = dm("Physical_Thing")
"""The root of the classes of physical things."""
LOCATION: Final = dm("Location")
"""The root of the classes of places."""
OBJECT: Final = dm("Object")
PROPERTY: Final = dm("Property")

COORDINATES: Final = dm("Coordinates")
THREE_DIM_SIZE: Final = dm("3Three_Dim_Size")
PREFERRED_REFERENCE: Final = dm("PreferredReference")
ALTERNATIVE_REFERENCE: Final = dm("AlternativeReference")

HAS_POSITION: Final = dm("hasPosition")
HAS_SIZE: Final = dm("hasSize")
HAS_EXTENT: Final = dm("hasExtent")
"""The property for the polygon of a place, a literal of `WKT_LITERAL`."""
HAS_PREFERRED_REFERENCE: Final = dm("hasPreferredReference")
HAS_ALTERNATIVE_REFERENCE: Final = dm("hasAlternativeReference")
LEXICAL_REFERENCE: Final = dm("lexicalReference")

COORDINATE_XYZ: Final = (
    dm("float_coordinates_x"),
    dm("float_coordinates_y"),
    dm("float_coordinates_z"),
)
ORIENTATION_WXYZ: Final = (
    dm("float_orientation_w"),
    dm("float_orientation_x"),
    dm("float_orientation_y"),
    dm("float_orientation_z"),
)
SIZE_XYZ: Final = (dm("float_size_x"), dm("float_size_y"), dm("float_size_z"))

HAS_AFFORDANCE: Final = dm("hasAffordance")
CONTAINING: Final = dm("containing")
SUPPORTING: Final = dm("supporting")
IS_LOCATED_IN: Final = dm("isLocatedIn")

IS_OPEN: Final = dm("isOpen")
OPENNESS: Final = dm("openness")
JOINT_POSITIONS: Final = dm("jointPositions")
"""The properties for openness and joint positions, each more precise than the previous one."""
IS_SWITCHED_ON: Final = dm("isSwitchedOn")
SWITCH_POSITIONS: Final = dm("switchPositions")
"""The properties for switch states; the second is more precise."""

IS_GRASPED_BY: Final = dm("isGraspedBy")
GRASP_POSE: Final = dm("graspPose")
"""The properties of an attachment: the parent entity, and the pose in its frame."""

CONFLICTING_OBSERVATION: Final = dm("conflictingObservation")
TRACKED_FROM: Final = dm("trackedFrom")
"""Annotation of an entity: an observation that contradicts the map."""

SPATIAL: Final = dm("spatial")
"""Annotation of a class: true for a root of the classes of physical things."""
SET_ASIDE: Final = dm("setAside")
"""Annotation of a term of the TBox: a statement about it that is ignored, and why."""
ENTITY_NAME: Final = "<urn:semmap:entityName>"
"""The name of an entity, if the last part of its IRI is the name of another one. It is not of a TBox."""
MODEL: Final = dm("model")
"""Annotation of a class, or of an entity: the name or file of its body model."""
FIXED: Final = dm("fixed")
"""Annotation of a class: whether its bodies are fixed."""


# ---- RDF, RDFS, OWL, XSD ----

RDF_TYPE: Final = iri(f"{RDF}type")
RDF_FIRST: Final = iri(f"{RDF}first")
RDF_REST: Final = iri(f"{RDF}rest")
RDF_NIL: Final = iri(f"{RDF}nil")
RDF_LANG_STRING: Final = iri(f"{RDF}langString")

RDFS_CLASS: Final = iri(f"{RDFS}Class")
RDFS_LABEL: Final = iri(f"{RDFS}label")
RDFS_COMMENT: Final = iri(f"{RDFS}comment")
RDFS_SUB_CLASS_OF: Final = iri(f"{RDFS}subClassOf")
RDFS_SUB_PROPERTY_OF: Final = iri(f"{RDFS}subPropertyOf")
RDFS_DOMAIN: Final = iri(f"{RDFS}domain")
RDFS_RANGE: Final = iri(f"{RDFS}range")

SKOS_PREF_LABEL: Final = iri("http://www.w3.org/2004/02/skos/core#prefLabel")
SKOS_ALT_LABEL: Final = iri("http://www.w3.org/2004/02/skos/core#altLabel")

OWL_CLASS: Final = iri(f"{OWL}Class")
OWL_THING: Final = iri(f"{OWL}Thing")
OWL_NOTHING: Final = iri(f"{OWL}Nothing")
OWL_ONTOLOGY: Final = iri(f"{OWL}Ontology")
OWL_IMPORTS: Final = iri(f"{OWL}imports")
OWL_OBJECT_PROPERTY: Final = iri(f"{OWL}ObjectProperty")
OWL_DATATYPE_PROPERTY: Final = iri(f"{OWL}DatatypeProperty")
OWL_INVERSE_OF: Final = iri(f"{OWL}inverseOf")
OWL_FUNCTIONAL_PROPERTY: Final = iri(f"{OWL}FunctionalProperty")
OWL_ANNOTATION_PROPERTY: Final = iri(f"{OWL}AnnotationProperty")
PROPERTY_KINDS: Final = (
    OWL_OBJECT_PROPERTY,
    OWL_DATATYPE_PROPERTY,
    OWL_ANNOTATION_PROPERTY,
    iri(f"{RDF}Property"),
)
OWL_NAMED_INDIVIDUAL: Final = iri(f"{OWL}NamedIndividual")
OWL_SAME_AS: Final = iri(f"{OWL}sameAs")
OWL_DIFFERENT_FROM: Final = iri(f"{OWL}differentFrom")

XSD_STRING: Final = iri(f"{XSD}string")
XSD_FLOAT: Final = iri(f"{XSD}float")
XSD_BOOLEAN: Final = iri(f"{XSD}boolean")
WKT_LITERAL: Final = iri("http://www.opengis.net/ont/geosparql#wktLiteral")
