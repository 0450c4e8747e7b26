"""Names of individuals whose IRIs have the same last part: `a.lamp` and `floor2.lamp`, as of two files.

The name is stored with the individual (`urn:semmap:entityName`), so that it stays the same when the others
change.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Set
from itertools import count

from semmap.ontology import prefixes
from semmap.ontology import vocabulary as v
from semmap.schemas import wording
from semmap.schemas.entities import Entity, name_of_text
from semmap.schemas.explanations import Term, Triple

_FEW = 5


def make_distinct_names(
    triples: Iterable[Triple],
    spatial: Set[Term],
    find: Callable[[str], Entity | None],
    of_file: prefixes.Prefixes,
) -> dict[Term, str]:
    """Return names with prefixes for the new entities of a document that would have the name of another one.

    `spatial` are the classes of entities, `find(name)` returns an entity of the map, and `of_file` are the
    prefixes in the document. An entity of the map, and one in the map's own namespace, keep their names.
    Individuals that the document states to be the same share a name.
    """
    triples = triples if isinstance(triples, list) else list(triples)
    sharing, used = _find_shared_names(triples, spatial, find)
    if not sharing:
        return {}
    named = {s for s, p, _ in triples if p == v.ENTITY_NAME}
    same = {frozenset((s, o)) for s, p, o in triples if p == v.OWL_SAME_AS}
    to_name: list[Term] = []
    for name, iris in sharing.items():
        holder = find(name)
        kept = [] if holder is None else [v.iri(holder.iri)]
        others = [iri for iri in sorted(iris, key=_is_elsewhere) if iri not in kept]
        distinct: list[Term] = []
        for iri in others:
            if not any(frozenset((iri, other)) in same for other in (*kept, *distinct)):
                distinct.append(iri)
        if kept or len(distinct) > 1:
            new = (iri for iri in distinct if iri not in named and not _is_known(iri, find))
            to_name += filter(_is_elsewhere, new)
    declared = {namespace: prefix for prefix, namespace in of_file.items()}
    return _name(to_name, lambda name: name in used or find(name) is not None, declared)


def describe(names: Mapping[Term, str]) -> str:
    """Return a note on the names."""
    few = wording.few([f"{name} ({iri})" for iri, name in sorted(names.items(), key=lambda n: n[1])], _FEW)
    return f"{wording.counted(len(names), 'name')} with a prefix, because the last part is not unique: {few}"


def name_triples(names: Mapping[Term, str]) -> list[Triple]:
    """Return the triples that store the names."""
    return [(iri, v.ENTITY_NAME, v.literal(name)) for iri, name in names.items()]


def _find_shared_names(
    triples: Iterable[Triple], spatial: Set[Term], find: Callable[[str], Entity | None]
) -> tuple[dict[str, list[Term]], Set[str]]:
    """Return the individuals of a document by name, for names that others have, too; and all names."""
    first: dict[str, Term] = {}
    shared: dict[str, list[Term]] = {}
    for s, p, o in triples:
        if p != v.RDF_TYPE or o not in spatial or not s.startswith("<"):
            continue
        name = v.own_name(s)
        known = first.setdefault(name, s)
        if known != s:
            among = shared.setdefault(name, [known])
            if s not in among:
                among.append(s)
        elif name not in shared and (holder := find(name)) is not None and v.iri(holder.iri) != s:
            shared[name] = [s]
    return shared, first.keys()


def _is_known(iri: Term, find: Callable[[str], Entity | None]) -> bool:
    """Return whether the map has an entity with this IRI, which keeps its name."""
    known = find(v.entity_name(iri))
    return known is not None and v.iri(known.iri) == iri


def _is_elsewhere(iri: Term) -> bool:
    return not iri.startswith(f"<{v.ABOX}")


def _name(
    iris: Iterable[Term], is_taken: Callable[[str], bool], declared: Mapping[str, str]
) -> dict[Term, str]:
    iris = list(iris)
    namespaces = {iri: prefixes.split(iri)[0] for iri in iris}
    chosen = {ns: prefix for prefix, ns in prefixes.prefixes_of(namespaces.values(), declared).items()}
    names: dict[Term, str] = {}
    taken: set[str] = set()
    for iri in iris:
        stem = name_of_text(f"{chosen[namespaces[iri]]}.{v.own_name(iri)}")
        made = (stem if number == 1 else f"{stem}_{number}" for number in count(1))
        names[iri] = next(name for name in made if name not in taken and not is_taken(name))
        taken.add(names[iri])
    return names
