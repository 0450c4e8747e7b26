"""Report on an ontology: its contents, ineffective or wrong axioms, and the time of changes with it."""

from __future__ import annotations

import itertools
import random
import time
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from statistics import median

from semmap.nodes.kb_node.documents import ontology_files
from semmap.nodes.kb_node.documents.abox_document import is_built_in
from semmap.nodes.kb_node.documents.inert_statements import count_inert
from semmap.nodes.kb_node.documents.ontology_files import VERSION, Gathered
from semmap.nodes.kb_node.documents.rule_terms import undeclared_terms
from semmap.nodes.kb_node.documents.tbox import tbox_declarations
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.entailment.explaining import empty_classes
from semmap.nodes.kb_node.reasoner.tbox.profile import outside_rl
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.ontology import entity_triples, prefixes
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.entities import Pose
from semmap.schemas.explanations import Term, Triple
from semmap.schemas.tbox_report import Quickness, TBoxReport, Unsatisfiable

_CLASSES = (v.OWL_CLASS, v.RDFS_CLASS)
_PATIENCE_S = 60.0
"""Time limit for testing classes, which is reached only if the reasoner is not incremental."""
_ADDS, _WARM_UP = 200, 20
_SEED = 13
_ADDING_S = 4.0
"""Time limit for adding individuals."""


def check(named: Sequence[Path], imports: Mapping[str, Path], spatial_root: Sequence[str] = ()) -> TBoxReport:
    """Return the report on ontology files with their imports.

    `spatial_root` are the roots of spatial classes. Raises BadFile for an unreadable file, UnknownClass.
    """
    gathered = ontology_files.gather(named, imports)
    tbox = tbox_declarations.with_declarations(
        gathered.triples, of_file=gathered.prefixes, spatial_root=spatial_root, files=named
    )
    began_s = time.process_time()
    try:
        reasoner = Reasoner(tbox)
    except Inconsistent as error:
        return _report(gathered, tbox, inconsistent=error.explanation.text)
    load_s = time.process_time() - began_s
    classes = _classes(gathered.triples)
    spatial_classes = _spatial(reasoner)  # before the explanations, because it makes class names unambiguous
    unsatisfiable = list(_unsatisfiable(reasoner, classes))
    allowed = [class_ for class_, why in unsatisfiable if not why]
    for empty in empty_classes(reasoner, allowed, _PATIENCE_S):
        if empty.conclusion is None:
            raise errors.InternalError("an empty class has no conclusion")
        unsatisfiable.append((empty.conclusion[0], empty.text))
    wrong = {class_ for class_, why in unsatisfiable if why}
    quickness = Quickness(
        load_s=load_s,
        add_p50_ms=_add_p50_ms(reasoner, [c for c in classes if c not in wrong]),
        not_incremental=reasoner.not_incremental or "",
    )
    return _report(
        gathered,
        tbox,
        spatial_classes=spatial_classes,
        unsatisfiable=tuple(Unsatisfiable(iri=v.bare(c), why=why) for c, why in unsatisfiable if why),
        untried=len(classes) - len({class_ for class_, _ in unsatisfiable}),
        quickness=quickness,
    )


def _report(
    gathered: Gathered,
    tbox: Collection[Triple],
    *,
    inconsistent: str = "",
    spatial_classes: int | None = None,
    unsatisfiable: tuple[Unsatisfiable, ...] = (),
    untried: int = 0,
    quickness: Quickness | None = None,
) -> TBoxReport:
    triples = gathered.triples
    versions = {s: v.bare(o) for s, p, o in triples if p == VERSION and o.startswith("<")}
    ontologies = [o for o in ontology_files.header(triples).ontologies if o.startswith("<")]
    classes = _classes(triples)
    kinds = outside_rl(filter(is_schema, triples))
    return TBoxReport(
        files=tuple(map(str, gathered.files)),
        ontologies={v.bare(o): versions.get(o, "") for o in ontologies},
        imports={iri: str(path) for iri, path in gathered.found.items()},
        missing=gathered.missing,
        triples=len(triples),
        classes=len(classes),
        spatial_classes=spatial_classes,
        spatial_candidate=_spatial_candidate(tbox) if spatial_classes == 0 else "",
        object_properties=len(_of(triples, v.OWL_OBJECT_PROPERTY)),
        data_properties=len(_of(triples, v.OWL_DATATYPE_PROPERTY)),
        annotation_properties=len(_of(triples, v.OWL_ANNOTATION_PROPERTY)),
        individuals=len(_individuals(triples)),
        outside_rl=dict(sorted(kinds.items(), key=lambda kind: (-kind[1], kind[0]))),
        inert=dict(sorted(count_inert(triples).items())),
        left_out=gathered.notes,
        undeclared=tuple(map(v.bare, undeclared_terms(tbox))),
        inconsistent=inconsistent,
        unsatisfiable=unsatisfiable,
        untried=untried,
        ambiguous=_ambiguous(tbox),
        quickness=quickness,
    )


def _of(triples: Iterable[Triple], *kinds: Term) -> set[Term]:
    return {s for s, p, o in triples if p == v.RDF_TYPE and o in kinds and s.startswith("<")}


def _classes(triples: Iterable[Triple]) -> list[Term]:
    return sorted(c for c in _of(triples, *_CLASSES) if not is_built_in(c))


def _individuals(triples: Collection[Triple]) -> set[Term]:
    described = {s for s, p, o in triples if p == v.RDF_TYPE and not is_built_in(o)}
    return described | _of(triples, v.OWL_NAMED_INDIVIDUAL)


def _ambiguous(tbox: Collection[Triple]) -> dict[str, dict[str, str]]:
    classes = _classes(tbox)
    terms = {*classes, *_of(tbox, *v.PROPERTY_KINDS)}
    known = prefixes.prefixes_of((prefixes.split(t)[0] for t in terms), prefixes.declared_in(tbox))
    shared = prefixes.told_apart(classes, known)
    return {local: {name: v.bare(c) for name, c in found.items()} for local, found in shared.items()}


def _spatial(reasoner: Reasoner) -> int | None:
    try:
        return len(ClassTable(reasoner).spatial)
    except errors.BadFile:
        return None


def _spatial_candidate(tbox: Collection[Triple]) -> str:
    """Return the name of the class with the most subclasses, or an empty text if there is no class."""
    classes = _classes(tbox)
    above: dict[Term, set[Term]] = {c: set() for c in classes}
    for s, p, o in tbox:
        if p == v.RDFS_SUB_CLASS_OF and s in above and o in above:
            above[s].add(o)
    below = dict.fromkeys(classes, 0)
    for c in classes:
        seen, rest = {c}, [c]
        while rest:
            more = above[rest.pop()] - seen
            seen |= more
            rest += more
        for ancestor in seen - {c}:
            below[ancestor] += 1
    known = prefixes.prefixes_of((prefixes.split(c)[0] for c in classes), prefixes.declared_in(tbox))
    names = prefixes.names(classes, known)
    return names[min(classes, key=lambda c: (-below[c], c))] if classes else ""


def _unsatisfiable(reasoner: Reasoner, classes: Iterable[Term]) -> Iterator[tuple[Term, str]]:
    """Yield each tested class with why it is unsatisfiable by the rules, or "".

    An individual of the class is added and removed again.
    """
    began_s = time.monotonic()
    for class_, triple in ((c, (v.entity_iri("x"), v.RDF_TYPE, c)) for c in classes):
        if time.monotonic() - began_s > _PATIENCE_S:
            return
        try:
            reasoner.apply(insert=[triple])
        except Inconsistent as error:
            yield class_, error.explanation.text
        else:
            reasoner.apply(delete=[triple])
            yield class_, ""


def _add_p50_ms(reasoner: Reasoner, classes: Sequence[Term]) -> float | None:
    """Return the median time to add an individual with a position and a label, and to check what follows.

    The individuals are of classes from the whole ontology and stay, as in a map. If changes are slow, fewer
    are added.
    """
    classes = random.Random(_SEED).sample(classes, len(classes))
    took_s: list[float] = []
    began_s = time.monotonic()
    for i, class_ in enumerate(itertools.islice(itertools.cycle(classes), _ADDS + _WARM_UP)):
        star = entity_triples.describe(
            f"x{i}", class_, pose=Pose(position_m=(float(i), 1.0, 0.5)), preferred=f"thing {i}"
        )
        start_s = time.perf_counter()
        try:
            reasoner.apply(insert=star)
        except Inconsistent:
            continue
        took_s.append(time.perf_counter() - start_s)
        if time.monotonic() - began_s > _ADDING_S:
            break
    measured = took_s[_WARM_UP:] or took_s
    return median(measured) * 1e3 if measured else None
