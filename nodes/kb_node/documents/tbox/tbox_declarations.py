"""What a TBox is told besides its own triples, and keeps: prefixes of its file, and what is in space.

Both become triples of the TBox, so they hold over restarts, are in its history and go with it.
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


def declared(
    tbox: Iterable[Triple],
    *,
    of_file: Prefixes = MappingProxyType({}),
    spatial_root: Sequence[str] = (),
    files: Sequence[Path] = (),
) -> list[Triple]:
    """`tbox` with the prefixes of its file, and with the classes that are roots of what is in space.

    What its alignments set aside is left out, and that is said of whatever it was about.

    Each word of `spatial_root` is an IRI or a class's name. If the household TBox is one of several `files`,
    its classes of things in space remain such beside these roots. Raises UnknownClass.
    """
    triples = _without_what_is_set_aside(list(tbox))
    triples += prefixes.declarations(of_file, triples)
    if spatial_root:
        find = _ClassFinder(triples)
        triples += [(find(word), v.SPATIAL, _TRUE) for word in spatial_root]
    if len(files) > 1 and HOUSEHOLD_TTL in files and any(p == v.SPATIAL for _, p, _ in triples):
        triples.append((v.PHYSICAL_THING, v.SPATIAL, _TRUE))
    return list(dict.fromkeys(triples))


def _without_what_is_set_aside(triples: list[Triple]) -> list[Triple]:
    there = set(triples)
    namespaces = {prefixes.split(c)[0] for c in _classes(triples)}
    for aside in (aside for known in alignments.of_namespaces(namespaces) for aside in known.set_aside):
        if aside.triple in there:
            there.remove(aside.triple)
            subject, predicate, _ = aside.triple
            text = f"{v.local_name(predicate)} {v.local_name(aside.triple[2])}: {aside.why}"
            triples = [t for t in triples if t != aside.triple]
            triples.append((subject, v.SET_ASIDE, v.literal(text)))
            triples += [aside.instead] if aside.instead is not None else []
    return triples


def extension(
    new: Iterable[Triple],
    present: frozenset[Triple],
    classes: ClassTable,
    *,
    of_file: Prefixes = MappingProxyType({}),
    spatial_root: Sequence[str] = (),
) -> list[Triple]:
    """Return the triples that extend the present TBox by `new`, with what `declared` adds to both together.

    The present prefixes and spatial classes remain. Raises UnknownClass.
    """
    namespaces = set(classes.prefixes.values())

    def is_free(prefix: str, namespace: str) -> bool:
        return prefix not in classes.prefixes and namespace not in namespaces

    new = [(s, p, o) for s, p, o in new if p != prefixes.PREFERRED_PREFIX or is_free(v.lexical(o), v.bare(s))]
    free = {prefix: namespace for prefix, namespace in of_file.items() if is_free(prefix, namespace)}
    whole = declared([*sorted(present), *new], of_file=free, spatial_root=spatial_root)
    added = [t for t in whole if t not in present]
    roots = {o for s, p, o in added if (s, p) == (v.HAS_POSITION, v.RDFS_DOMAIN)}
    roots |= {v.PHYSICAL_THING} & _classes(added)
    if not classes.declared_roots and (any(p == v.SPATIAL for _, p, _ in added) or roots):
        roots.update(classes.spatial_roots)  # which would otherwise be superseded by those of the file
        added += [(c, v.SPATIAL, _TRUE) for c in sorted(roots)]
    return list(dict.fromkeys(added))


def keeping_roots(tbox: Sequence[Triple], before: ClassTable) -> list[Triple]:
    """A TBox that declares no spatial roots itself, with those of the one before, as far as it has these."""
    if any(p == v.SPATIAL for _, p, _ in tbox):
        return list(tbox)
    classes = _classes(tbox)
    kept = [(c, v.SPATIAL, _TRUE) for c in before.declared_roots if c in classes]
    return [*tbox, *kept]


def _classes(triples: Iterable[Triple]) -> set[Term]:
    kinds = (v.OWL_CLASS, v.RDFS_CLASS)
    return {s for s, p, o in triples if p == v.RDF_TYPE and o in kinds and s.startswith("<")}


class _ClassFinder:
    """Finds a class by what somebody calls it, among those that triples declare or put others below."""

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
        """The class. Raises UnknownClass."""
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
