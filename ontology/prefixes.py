"""Prefixes of namespaces, which distinguish IRIs with the same local name.

A namespace's prefix is the well-known one, or else the one that the ontology declares, or else one generated
from the namespace. So an ontology gets the same names from any file. Declared prefixes are stored in its
triples (`vann:preferredNamespacePrefix`) and thereby in the map.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from itertools import count
from types import MappingProxyType
from typing import Final
from urllib.parse import unquote, urlsplit

from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple

Prefixes = Mapping[str, str]
"""Prefix to namespace, both without the punctuation of a syntax: `{"dm": "http://...#"}`."""

WELL_KNOWN: Final[Prefixes] = MappingProxyType(
    {
        **v.PREFIXES,
        "rdf": v.RDF,
        "rdfs": v.RDFS,
        "brick": "https://brickschema.org/schema/Brick#",
        "cyc": "http://sw.opencyc.org/concept/",
        "dbp": "http://dbpedia.org/property/",
        "dc": "http://purl.org/dc/elements/1.1/",
        "dcterms": "http://purl.org/dc/terms/",
        "dul": "http://www.ontologydesignpatterns.org/ont/dul/DUL.owl#",
        "foaf": "http://xmlns.com/foaf/0.1/",
        "geo": "http://www.opengis.net/ont/geosparql#",
        "knowrob": "http://knowrob.org/kb/knowrob.owl#",
        "obo": "http://purl.obolibrary.org/obo/",
        "oro": "http://kb.openrobots.org#",
        "owl": v.OWL,
        "prov": "http://www.w3.org/ns/prov#",
        "qudt": "http://qudt.org/schema/qudt/",
        "schema": "https://schema.org/",
        "skos": "http://www.w3.org/2004/02/skos/core#",
        "soma": "http://www.ease-crc.org/ont/SOMA.owl#",
        "sosa": "http://www.w3.org/ns/sosa/",
        "ssn": "http://www.w3.org/ns/ssn/",
        "time": "http://www.w3.org/2006/time#",
        "urdf": "http://knowrob.org/kb/urdf.owl#",
        "vann": "http://purl.org/vocab/vann/",
    }
)
PREFERRED_PREFIX: Final[Term] = v.iri(WELL_KNOWN["vann"] + "preferredNamespacePrefix")
"""The annotation property for the prefix of a namespace."""

_PREFIX = re.compile(r"[a-z][a-z0-9_-]*")
_SUFFIXES = re.compile(r"\.(owl|ofn|omn|owx|rdf|rdfs|ttl|nt|xml|jsonld|json|obo)$", re.IGNORECASE)
_VERSION = re.compile(r"v?[0-9][0-9.]*$", re.IGNORECASE)
_OF_VERSION = re.compile(r"[-_.]v?[0-9]+(\.[0-9]+)+$", re.IGNORECASE)
"""A version at the end of a word. Other digits belong to it: `floor2`."""


def split(iri: Term) -> tuple[str, str]:
    """Split an IRI term into namespace and local name, like `vocabulary.local_name`."""
    local = v.local_name(iri)
    text = v.bare(iri)
    return text[: len(text) - len(local)], local


def declared_in(triples: Iterable[Triple]) -> dict[str, str]:
    """Return the prefixes that an ontology's triples declare, by namespace."""
    declared = sorted((s, o) for s, p, o in triples if p == PREFERRED_PREFIX and o.startswith('"'))
    return {v.bare(s): v.lexical(o) for s, o in declared if s.startswith("<")}


def declarations(of_file: Prefixes, triples: Collection[Triple]) -> list[Triple]:
    """Return triples that declare the prefixes of the namespaces in which `triples` define terms.

    `of_file` are the prefixes in the file. Well-known prefixes are left out.
    """
    kinds = (v.OWL_CLASS, v.RDFS_CLASS, *v.PROPERTY_KINDS)
    used = {split(s)[0] for s, p, o in triples if p == v.RDF_TYPE and o in kinds and s.startswith("<")}
    declared = {namespace: prefix for prefix, namespace in sorted(of_file.items(), reverse=True)}
    chosen = prefixes_of(used, {**declared, **declared_in(triples)})
    own = [(prefix, namespace) for prefix, namespace in chosen.items() if WELL_KNOWN.get(prefix) != namespace]
    found = [(v.iri(namespace), PREFERRED_PREFIX, v.literal(prefix)) for prefix, namespace in own]
    return [(PREFERRED_PREFIX, v.RDF_TYPE, v.OWL_ANNOTATION_PROPERTY), *found] if found else []


def used_by(triples: Iterable[Triple], prefixes: Prefixes) -> dict[str, str]:
    """Return the prefixes that the properties and classes of `triples` need, and the map's own."""
    terms = {o if p == v.RDF_TYPE else p for _, p, o in triples}
    namespaces = {split(term)[0] for term in terms if term.startswith("<")}
    needed = {prefix: namespace for prefix, namespace in prefixes.items() if namespace in namespaces}
    return {**v.PREFIXES, **needed}


def prefixes_of(
    namespaces: Iterable[str], declared: Mapping[str, str] = MappingProxyType({})
) -> dict[str, str]:
    """Return a unique prefix for each of `namespaces`; `declared` maps namespaces to prefixes.

    The result does not depend on the order of the namespaces.
    """
    known = {namespace: prefix for prefix, namespace in WELL_KNOWN.items() if prefix}
    used = set(namespaces)
    found: dict[str, str] = {}
    rest: list[str] = []
    for namespace in sorted(used):
        other = other_scheme(namespace)
        if namespace in known:
            found[known[namespace]] = namespace
        elif other in known and other not in used:
            found[known[other]] = namespace
        else:
            rest.append(namespace)
    sharing: list[tuple[str, str]] = []
    for namespace in sorted(rest, key=lambda namespace: (namespace not in declared, namespace)):
        wanted = declared.get(namespace, "").lower()
        stem = wanted if _PREFIX.fullmatch(wanted) else _made_from(namespace)
        if stem in found or stem in WELL_KNOWN:
            sharing.append((stem, namespace))
        else:
            found[stem] = namespace
    for stem, namespace in sharing:  # last, so that `lab2` is not the second `lab` if a namespace is `lab2`
        numbered = (f"{stem}{number}" for number in count(2))
        found[next(prefix for prefix in numbered if prefix not in found)] = namespace
    return dict(sorted(found.items()))


def other_scheme(namespace: str) -> str:
    """Return the namespace with `http` instead of `https`, or the reverse."""
    scheme, separator, rest = namespace.partition("://")
    return {"http": "https", "https": "http"}.get(scheme, scheme) + separator + rest


def prefixed(iri: Term, prefixes: Prefixes) -> str:
    """Return `prefix:local`, or the IRI itself if its namespace has no prefix."""
    namespace, local = split(iri)
    prefix = next((prefix for prefix, known in prefixes.items() if known == namespace), None)
    return v.bare(iri) if prefix is None else f"{prefix}:{local}"


def names(iris: Collection[Term], prefixes: Prefixes) -> dict[Term, str]:
    """Return a name for each IRI: its local name, or `prefix:local` if several share it.

    No two have the same name, and an IRI that ends in no local name is called by what stands before it.
    """
    parts = {iri: split(iri) for iri in iris}
    by_namespace = {namespace: prefix for prefix, namespace in prefixes.items()}
    bare = {iri: local or _made_from(namespace) for iri, (namespace, local) in parts.items()}
    shared = Counter(bare.values())

    def name(iri: Term) -> str:
        namespace, local = parts[iri]
        if shared[bare[iri]] == 1 and ":" not in local:
            return bare[iri]
        return f"{by_namespace[namespace]}:{local}"

    return {iri: name(iri) for iri in iris}


def told_apart(iris: Collection[Term], prefixes: Prefixes) -> dict[str, dict[str, Term]]:
    """Return each local name that several IRIs share, with their prefixed names and IRIs."""
    sharing: dict[str, dict[str, Term]] = {}
    for iri in sorted(iris):
        sharing.setdefault(v.local_name(iri), {})[prefixed(iri, prefixes)] = iri
    return {local: dict(sorted(found.items())) for local, found in sorted(sharing.items()) if len(found) > 1}


def _made_from(namespace: str) -> str:
    """Return a prefix from the last significant word of a namespace: `lab` for `http://x.org/lab.owl#`."""
    parts = urlsplit(namespace)
    words = [_SUFFIXES.sub("", unquote(word)) for word in re.split("[/:]", parts.path) if word]
    telling = [word for word in words if not _VERSION.fullmatch(word)]
    word = telling[-1] if telling else (parts.hostname or "").removeprefix("www.").partition(".")[0]
    plain = re.sub(r"[^a-z0-9_-]+", "_", _OF_VERSION.sub("", word).lower())
    return plain.lstrip("_-0123456789").rstrip("_-") or "ns"
