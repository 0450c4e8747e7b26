"""Functional and Manchester syntax and OWL/XML, read by py-horned-owl. Errors include the line."""

from __future__ import annotations

import re
from contextlib import suppress
from typing import Literal
from xml.parsers import expat

import pyhornedowl

from semmap.nodes.kb_node.documents.owl.axiom_triples import triples_of
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Triple
from semmap.schemas.nesting import limit_entities

OwlSyntax = Literal["functional", "manchester", "owlxml"]

_HORNED: dict[OwlSyntax, Literal["ofn", "omn", "owx"]] = {
    "functional": "ofn",
    "manchester": "omn",
    "owlxml": "owx",
}
_CHUNK = 1 << 16
_IRI = re.compile(r"<[A-Za-z][A-Za-z0-9+.-]*:[^\x00-\x20<>\"{}|^`\\]*>")
_COMMENTS = rb"(?:\s|#[^\n]*(?:\n|\Z))*"
_FUNCTIONAL = re.compile(_COMMENTS + rb"(Prefix|Ontology)\s*\(")
_MANCHESTER = re.compile(
    _COMMENTS + rb"(Prefix:\s+[^\s<]*:\s*<|Ontology:\s*(<|[A-Za-z]+:\s*(\n|\Z)|\w*:\w+\s*\n|\Z))"
)
_STANDARD = {"owl": v.OWL, "rdf": v.RDF, "rdfs": v.RDFS, "xsd": v.XSD}
_DECLARED: dict[OwlSyntax, str] = {
    "functional": r"Prefix\s*\(\s*{}:\s*=",
    "manchester": r"Prefix:\s+{}:\s",
}
_DECLARE: dict[OwlSyntax, str] = {"functional": "Prefix({}:=<{}>) ", "manchester": "Prefix: {}: <{}> "}
_PREFIXES: dict[OwlSyntax, re.Pattern[str]] = {
    "functional": re.compile(r"^\s*Prefix\s*\(\s*([\w.-]*):\s*=\s*<([^>\s]*)>", re.MULTILINE),
    "manchester": re.compile(r"^\s*Prefix:\s+([\w.-]*):\s+<([^>\s]*)>", re.MULTILINE),
    "owlxml": re.compile(r"""<Prefix\s+name=["']([\w.-]*)["']\s+IRI=["']([^"'\s]*)["']"""),
}
_ABBREVIATED = (
    (r"""(?<=\s)abbreviatedIRI(\s*=\s*["']){}:""", r"IRI\1{}"),
    (r"<((?:\w+:)?)AbbreviatedIRI>[ \t]*{}:([^<\s]*)[ \t]*</\1AbbreviatedIRI>", r"<\1IRI>{}\2</\1IRI>"),
)
"""Patterns of names with a prefix in OWL/XML, and the same as whole IRIs."""
_LINE = re.compile(r"line_col: \w+\(\((\d+), (\d+)\)")
_BYTE = re.compile(r"Byte(?:Position|Span)\((\d+)")
_EXPECTED = re.compile(r"positives: \[([^\]]*)\]")
_VALIDITY = re.compile(r'ValidityError\("([^"]*)"')
_THAT = re.compile(r'("(?:\\.|[^"\\])*"|<[^>\s]*>|(?:^|(?<=\s))#[^\n]*)|(?<=\s)that(?=[\s(])', re.DOTALL)
_REFERENCE = re.compile(r"&(\w[\w.-]*);")
_OF_XML = frozenset({"lt", "gt", "amp", "apos", "quot"})
_DOCTYPE = re.compile(r"<!DOCTYPE[^\[>]*(\[.*?\]\s*)?>", re.DOTALL)


def prefixes(text: str, syntax: OwlSyntax) -> dict[str, str]:
    """Return the declared prefixes with their namespaces."""
    return {match[1]: match[2] for match in _PREFIXES[syntax].finditer(text)}


def owl_syntax_of(content: bytes) -> OwlSyntax | None:
    """Return the OWL syntax that `content` begins like, or None."""
    if _FUNCTIONAL.match(content):
        return "functional"
    if _MANCHESTER.match(content):
        return "manchester"
    return None


def is_owl_xml(content: bytes) -> bool:
    """Return whether it is OWL/XML. RDF/XML may begin with an ontology, too, but with an RDF attribute."""
    root: list[str] = []

    def note(name: str, attributes: dict[str, str]) -> None:
        if not root:
            root.extend((name, *attributes))

    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartElementHandler = note
    limit_entities(parser)
    with suppress(expat.ExpatError, ValueError):  # which reading reports
        for start in range(0, len(content), _CHUNK):
            parser.Parse(content[start : start + _CHUNK], False)
            if root:
                break
    return root[:1] == [f"{v.OWL} Ontology"] and not any(name.startswith(v.RDF) for name in root)


def parse(text: str, syntax: OwlSyntax) -> list[Triple]:
    """Return the triples of an ontology. Raises ValueError with the line of the error."""
    prepared = _prepared_xml(text) if syntax == "owlxml" else _with_prefixes(text, syntax)
    try:
        ontology = pyhornedowl.open_ontology_from_string(prepared, serialization=_HORNED[syntax])
    except ValueError as error:
        raise ValueError(_describe_error(str(error), text, prepared)) from None
    triples = triples_of(ontology.get_components())
    for term in {term for triple in triples for term in triple}:
        if term.startswith("<") and not _IRI.fullmatch(term):
            at = max(text.find(term), text.find(f'"{term[1:-1]}"'))
            line = f"line {text.count(chr(10), 0, at) + 1}: " if at >= 0 else ""
            raise ValueError(f"{line}{term} is not an absolute IRI")
    return triples


def _with_prefixes(text: str, syntax: OwlSyntax) -> str:
    """Return the text with declarations of the four standard prefixes, without adding a line."""
    if syntax == "manchester":
        text = _THAT.sub(lambda found: found[1] or "and", text)
    missing = [name for name in _STANDARD if not re.search(_DECLARED[syntax].format(name), text)]
    return "".join(_DECLARE[syntax].format(name, _STANDARD[name]) for name in missing) + text


def _prepared_xml(text: str) -> str:
    """Return OWL/XML with expanded entities and standard prefixes, on the same lines.

    Raises ValueError for an unknown prefix.
    """
    entities: dict[str, str] = {}
    declared = set[str]()
    words: list[str] = []
    """The texts in the current element."""
    parser = expat.ParserCreate(namespace_separator=" ")

    def require_declared(name: str) -> None:
        if ":" in name and name.partition(":")[0] not in declared | _STANDARD.keys():
            raise ValueError(f"line {parser.CurrentLineNumber}: undefined prefix ({name})")

    def begin(element: str, attributes: dict[str, str]) -> None:
        words.clear()
        if element == f"{v.OWL} Prefix":
            declared.add(attributes.get("name", ""))
        if (name := attributes.get("abbreviatedIRI", ":")) != ":":
            require_declared(name)

    def end(element: str) -> None:
        if element == f"{v.OWL} AbbreviatedIRI":
            require_declared("".join(words).strip())

    parser.EntityDeclHandler = lambda name, _, value, *where: entities.setdefault(name, value or "")
    parser.StartElementHandler, parser.EndElementHandler = begin, end
    parser.CharacterDataHandler = words.append
    parser.Parse(text.encode(), True)
    for name in _STANDARD.keys() - declared:  # those that py-horned-owl does not know, either
        for pattern, whole in _ABBREVIATED:
            text = re.sub(pattern.replace("{}", name), whole.replace("{}", _STANDARD[name]), text)
    if not entities:
        return text

    def written_out(found: re.Match[str]) -> str:
        name = found[1]
        if name in _OF_XML or name not in entities:
            return found[0]
        return _REFERENCE.sub(written_out, entities[name])

    body = _DOCTYPE.sub(lambda found: "\n" * found[0].count("\n"), text, count=1)
    return _REFERENCE.sub(written_out, body)


def _describe_error(fault: str, text: str, prepared: str) -> str:
    """Return a readable error with its line. `prepared` has the same lines as `text`."""
    if place := _LINE.search(fault):
        line, shown = int(place[1]), text.splitlines()[int(place[1]) - 1 :][:1]
        expected = _EXPECTED.search(fault)
        kinds = expected[1].split(", ") if expected and expected[1] else []
        return f"line {line} cannot be read{_hint(kinds)}: {_short(shown[0] if shown else '')}"
    if place := _BYTE.search(fault):
        at = int(place[1])
        line = prepared.encode()[:at].count(b"\n") + 1
        validity = _VALIDITY.search(fault)
        token = prepared.encode()[at : at + 60].decode(errors="ignore").split()
        what = validity[1] if validity else fault
        return f"line {line}: {what}" + (f" ({token[0]})" if what == "undefined prefix" and token else "")
    return fault.removeprefix("Failed to open ontology: ")


def _hint(kinds: list[str]) -> str:
    """Return what is expected at the position, if that is one to three things."""
    if not 0 < len(kinds) <= 3 or "EOI" in kinds:
        return ""
    words = dict.fromkeys("absolute IRI" if kind.startswith("RFC3987") else _in_words(kind) for kind in kinds)
    return f", where {' or '.join(words)} is expected"


def _in_words(kind: str) -> str:
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", kind.removesuffix("Kw")).lower()


def _short(line: str) -> str:
    line = line.strip()
    return f"'{line[:77]}...'" if len(line) > 80 else f"'{line}'"
