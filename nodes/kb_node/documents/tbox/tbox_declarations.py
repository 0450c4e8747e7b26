"""Declarations that are added to a TBox: the prefixes of its file, and the roots of spatial classes.

They become triples of the TBox, so they survive restarts and are part of its history.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from types import MappingProxyType

from semmap.nodes.kb_node.entities import alignments
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.ontology import HOUSEHOLD_TTL, prefixes
from semmap.ontology import vocabulary as v
from semmap.ontology.name_index import Ambiguous, Named, NameIndex
from semmap.ontology.prefixes import Prefixes
from semmap.schemas import errors
from semmap.schemas.explanations import Term, Triple

_TRUE = v.literal("true", v.XSD_BOOLEAN)


def with_declarations(
    tbox: Iterable[Triple],
    *,
    of_file: Prefixes = MappingProxyType({}),
    spatial_root: Sequence[str] = (),
    files: Sequence[Path] = (),
) -> list[Triple]:
    """Return `tbox` with the prefixes of its file and with declared spatial roots.

    Statements that its alignments ignore are left out, with a note on their subjects. Each word of
    `spatial_root` is an IRI or a class name. If the household TBox is one of several `files`, its spatial
    classes remain spatial beside these roots. Raises UnknownClass.
    """
    triples = _without_ignored_statements(list(tbox))
    triples += prefixes.declarations(of_file, triples)
    if spatial_root:
        find = _ClassFinder(triples)
        triples += [(find(word), v.SPATIAL, _TRUE) for word in spatial_root]
    if len(files) > 1 and HOUSEHOLD_TTL in files and any(p == v.SPATIAL for _, p, _ in triples):
        triples.append((v.PHYSICAL_THING, v.SPATIAL, _TRUE))
    return list(dict.fromkeys(triples))


def _without_ignored_statements(triples: list[Triple]) -> list[Triple]:
    present = set(triples)
    namespaces = {prefixes.split(c)[0] for c in _classes(triples)}
    for ignored in (
        ignored for known in alignments.find_for_namespaces(namespaces) for ignored in known.set_aside
    ):
        if ignored.triple in present:
            present.remove(ignored.triple)
            subject, predicate, _ = ignored.triple
            text = f"{v.local_name(predicate)} {v.local_name(ignored.triple[2])}: {ignored.why}"
            triples = [t for t in triples if t != ignored.triple]
            triples.append((subject, v.SET_ASIDE, v.literal(text)))
            triples += [ignored.instead] if ignored.instead is not None else []
    return triples


def find_extension(
    new: Iterable[Triple],
    present: frozenset[Triple],
    classes: ClassTable,
    *,
    of_file: Prefixes = MappingProxyType({}),
    spatial_root: Sequence[str] = (),
) -> list[Triple]:
    """Return the triples that extend the present TBox by `new`, with the declarations of both together.

    The present prefixes and spatial classes remain. Raises UnknownClass.
    """
    namespaces = set(classes.prefixes.values())

    def is_free(prefix: str, namespace: str) -> bool:
        return prefix not in classes.prefixes and namespace not in namespaces

    new = [(s, p, o) for s, p, o in new if p != prefixes.PREFERRED_PREFIX or is_free(v.lexical(o), v.bare(s))]
    free = {prefix: namespace for prefix, namespace in of_file.items() if is_free(prefix, namespace)}
    whole = with_declarations([*sorted(present), *new], of_file=free, spatial_root=spatial_root)
    added = [t for t in whole if t not in present]
    roots = {o for s, p, o in added if (s, p) == (v.HAS_POSITION, v.RDFS_DOMAIN)}
    roots |= {v.PHYSICAL_THING} & _classes(added)
    if not classes.declared_roots and (any(p == v.SPATIAL for _, p, _ in added) or roots):
        roots.update(classes.spatial_roots)  # the roots of the file would replace them
        added += [(c, v.SPATIAL, _TRUE) for c in sorted(roots)]
    return list(dict.fromkeys(added))


def with_spatial_roots_of(tbox: Sequence[Triple], before: ClassTable) -> list[Triple]:
    """Return a TBox with the spatial roots of the previous one, unless it declares its own."""
    if any(p == v.SPATIAL for _, p, _ in tbox):
        return list(tbox)
    classes = _classes(tbox)
    kept = [(c, v.SPATIAL, _TRUE) for c in before.declared_roots if c in classes]
    return [*tbox, *kept]


def _classes(triples: Iterable[Triple]) -> set[Term]:
    kinds = (v.OWL_CLASS, v.RDFS_CLASS)
    return {s for s, p, o in triples if p == v.RDF_TYPE and o in kinds and s.startswith("<")}


class _ClassFinder:
    """Finds a class by name or label among those that triples declare or use as superclasses."""

    def __init__(self, triples: Sequence[Triple]) -> None:
        above = {o for _, p, o in triples if p == v.RDFS_SUB_CLASS_OF and o.startswith("<")}
        classes = sorted(_classes(triples) | above)
        known = prefixes.prefixes_of((prefixes.split(c)[0] for c in classes), prefixes.declared_in(triples))
        names = prefixes.names(classes, known)
        labels: dict[Term, list[str]] = {}
        for s, p, o in triples:
            if p == v.RDFS_LABEL and o.startswith('"'):
                labels.setdefault(s, []).append(v.lexical(o))
        self._index = NameIndex(
            Named(name, v.bare(c), prefixes.prefixed(c, known), tuple(labels.get(c, ())))
            for c, name in names.items()
        )
        self._by_name = {name: c for c, name in names.items()}

    def __call__(self, word: str) -> Term:
        """Return the class. Raises UnknownClass."""
        try:
            name = self._index.find(word)
        except Ambiguous as error:
            raise errors.UnknownClass(
                f"--spatial-root {word} is ambiguous: {error}; say which class"
            ) from None
        if name is None:
            hint = self._index.did_you_mean(word)
            raise errors.UnknownClass(f"--spatial-root {word}: the TBox has no such class{hint}")
        return self._by_name[name]
