"""RDF terms as strings in N-Triples syntax, and the vocabulary of the rules."""

from __future__ import annotations

import re
from functools import cache
from typing import Final, NamedTuple

from semmap.nodes.kb_node.reasoner.explanations import Term

PREFIXES: Final = {
    "rdf": "http://www.w3.org/1999/02/22-rdf-syntax-ns#",
    "rdfs": "http://www.w3.org/2000/01/rdf-schema#",
    "owl": "http://www.w3.org/2002/07/owl#",
    "xsd": "http://www.w3.org/2001/XMLSchema#",
}
_LITERAL = re.compile(r'"((?:[^"\\]|\\.)*)"(?:@([A-Za-z0-9-]+)|\^\^<([^>]*)>)?', re.DOTALL)
_ESCAPE = re.compile(r"\\(?:u([0-9A-Fa-f]{4})|U([0-9A-Fa-f]{8})|(.))", re.DOTALL)
_PLAIN_TEXT = re.compile(r'[^"\\\x00-\x1f\x7f]*')
_SPECIAL = re.compile(r'["\\\x00-\x1f\x7f]')
_CONTROL = {"t": "\t", "b": "\b", "n": "\n", "r": "\r", "f": "\f"}
_ESCAPED = {char: "\\" + letter for letter, char in (*_CONTROL.items(), ('"', '"'), ("\\", "\\"))}


@cache
def iri(name: str) -> Term:
    """Return the term of a prefixed name, for example `iri("owl:Thing")`. `a` is rdf:type."""
    if name == "a":
        name = "rdf:type"
    prefix, local = name.split(":", 1)
    return f"<{PREFIXES[prefix]}{local}>"


def iris(names: str) -> tuple[Term, ...]:
    """Return the terms of prefixed names that are separated by spaces."""
    return tuple(map(iri, names.split()))


TYPE: Final = iri("rdf:type")
FIRST: Final = iri("rdf:first")
REST: Final = iri("rdf:rest")
NIL: Final = iri("rdf:nil")
SAME_AS: Final = iri("owl:sameAs")
DIFFERENT_FROM: Final = iri("owl:differentFrom")
THING: Final = iri("owl:Thing")
NOTHING: Final = iri("owl:Nothing")


class Literal(NamedTuple):
    """A parsed literal: text without escapes, the datatype's IRI (no brackets), language or ''."""

    text: str
    datatype: str
    language: str


def is_literal(term: Term) -> bool:
    """Return whether a term is a literal."""
    return term[0] == '"'


def is_named(term: Term) -> bool:
    """Return whether a term is an IRI."""
    return term[0] == "<"


def is_reserved(term: Term) -> bool:
    """Return whether a term is an IRI of the RDF, RDFS, OWL or XSD vocabulary."""
    return term.startswith(_RESERVED)


_RESERVED = tuple(f"<{namespace}" for namespace in PREFIXES.values())


def literal(term: Term) -> Literal:
    """Parse a literal.

    Raises:
        ValueError: the term is not a literal in N-Triples syntax.
    """
    match = _LITERAL.fullmatch(term)
    if match is None:
        raise ValueError(f"not a literal in N-Triples syntax: {term}")
    text, language, datatype = match.groups()
    if "\\" in text:
        text = _ESCAPE.sub(_unescaped, text)
    if language:
        return Literal(text, PREFIXES["rdf"] + "langString", language)
    return Literal(text, datatype or PREFIXES["xsd"] + "string", "")


def quoted(text: str, *, datatype: str = "", language: str = "") -> Term:
    """Return a literal as a term: the inverse of `literal`. `datatype` is an IRI without brackets."""
    escaped = text if _PLAIN_TEXT.fullmatch(text) else _SPECIAL.sub(_escaped, text)
    if language:
        return f'"{escaped}"@{language}'
    return f'"{escaped}"^^<{datatype}>' if datatype else f'"{escaped}"'


def _escaped(match: re.Match[str]) -> str:
    char = match[0]
    return _ESCAPED.get(char) or f"\\u{ord(char):04X}"


def _unescaped(match: re.Match[str]) -> str:
    short, long, char = match.groups()
    return _CONTROL.get(char, char) if char else chr(int(short or long, 16))
