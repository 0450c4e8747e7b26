"""Converts documents to transactions."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from itertools import chain
from operator import is_
from pathlib import Path
from types import MappingProxyType

from msgspec import structs

from semmap.nodes.kb_node.documents import abox_document, rdf
from semmap.nodes.kb_node.documents.replacement import Replacement, find_replacement
from semmap.nodes.kb_node.documents.tbox import tbox_declarations, tbox_validation
from semmap.nodes.kb_node.entities import entity_reading
from semmap.nodes.kb_node.entities.aligned_values import shift_along_z
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.shacl.shape_triples import find_shapes
from semmap.ontology import vocabulary as v
from semmap.ontology.prefixes import Prefixes
from semmap.schemas import errors, wording
from semmap.schemas.bridge import LoadDocument, LoadTBox
from semmap.schemas.commits import Transaction
from semmap.schemas.entities import Pose
from semmap.schemas.explanations import Term, Triple


def make_document_transaction(
    semantic_map: SemanticMap,
    load: LoadDocument,
    triples: Iterable[Triple],
    prefixes: Prefixes = MappingProxyType({}),
    *,
    coming: ClassTable | None = None,
    tbox: frozenset[Triple] | None = None,
) -> tuple[Transaction, abox_document.FilteredDocument, Replacement]:
    """Return the transaction of an ABox document, what was filtered from it, and what it replaces.

    `prefixes` are those in the document. `tbox` with the classes `coming` replaces the TBox in the same
    commit.

    Raises UnknownClass, BadFile for a TBox, UnknownName for undescribed individuals if the load is strict,
    and NameTaken if it may only add and the document has other values for what is in the map.
    """
    classes, tbox = coming or semantic_map.classes, semantic_map.tbox if tbox is None else tbox
    filtered = abox_document.filter_document(
        triples,
        classes,
        skip_unknown=load.skip_unknown,
        of_file=abox_document.DocumentOrigin(
            Path(load.filename).name,
            prefixes,
            abox_document.find_none if load.replace else semantic_map.find,
        ),
        find_frame=lambda iri: None if load.replace else _find_frame(semantic_map, iri),
    )
    stays = tbox.__contains__ if load.replace else lambda _: True
    if found := abox_document.find_undescribed(filtered.triples, semantic_map.reasoner, stays):
        note = abox_document.undescribed_note(found)
        if load.strict:
            raise errors.UnknownName(note)
        filtered.notes.append(f"{note}; --strict rejects such files")
    replaced = Replacement({}, filtered.triples)
    if not load.replace:
        replaced = find_replacement(filtered.triples, semantic_map.reasoner, classes, tbox)
    if replaced.retract and load.add_only:
        names = sorted({_name_owner(semantic_map, node) for node in replaced.retract})
        raise errors.NameTaken(
            f"{load.filename or 'the file'} has other values for {wording.few(names, 5)}; to replace those of"
            " the map, load it without --add-only"
        )
    transaction = _transaction(
        load,
        retract=semantic_map.abox() if load.replace else chain.from_iterable(replaced.retract.values()),
        insert=_outside(replaced.insert, tbox),
    )
    return transaction, filtered, replaced


def _name_owner(semantic_map: SemanticMap, node: Term) -> str:
    """Return the name of the entity that an individual is or describes, else that of the individual."""
    owners = entity_reading.find_owners(semantic_map.reasoner, semantic_map.classes, node)
    found = filter(None, map(semantic_map.find_by_individual, sorted(owners)))
    return next((entity.name for entity in found), v.entity_name(node))


def _find_frame(semantic_map: SemanticMap, iri: Term) -> Pose | None:
    """Return the pose of an entity of the map, with its middle as position."""
    entity = semantic_map.find_by_individual(iri)
    if entity is None or entity.pose is None:
        return None
    pose, half_m = entity.pose, entity.size_m[2] / 2.0 if entity.size_m is not None else 0.0
    return structs.replace(pose, position_m=shift_along_z(pose.position_m, pose.orientation_wxyz, half_m))


def is_exact_copy(triples: Sequence[Triple], transaction: Transaction) -> bool:
    """Return whether a transaction inserts exactly the triples of a document."""
    insert = transaction.insert
    return not transaction.retract and len(insert) == len(triples) and all(map(is_, insert, triples))


def _outside(triples: list[Triple], tbox: frozenset[Triple]) -> Iterable[Triple]:
    """Return the triples that are not in the TBox."""
    stated = tbox.intersection(triples)
    return (t for t in triples if t not in stated) if stated else triples


def complete_tbox(semantic_map: SemanticMap, load: LoadTBox, document: rdf.Document) -> list[Triple]:
    """Return the triples of a TBox, or those that an extension adds, with prefixes and spatial roots.

    The spatial roots that the present TBox declares stay until others are declared. Raises BadFile,
    UnknownClass.
    """
    triples = document.triples
    if load.extend:
        _require_schema(semantic_map, load, triples)
        return tbox_declarations.find_extension(
            triples,
            semantic_map.tbox,
            semantic_map.classes,
            of_file=document.prefixes,
            spatial_root=load.spatial_root,
        )
    triples = tbox_declarations.with_declarations(
        triples, of_file=document.prefixes, spatial_root=load.spatial_root
    )
    return (
        triples
        if load.spatial_root
        else tbox_declarations.with_spatial_roots_of(triples, semantic_map.classes)
    )


def _require_schema(semantic_map: SemanticMap, load: LoadTBox, triples: Collection[Triple]) -> None:
    """Raise BadFile for a file without axioms, SHACL shapes and statements about terms of the TBox."""
    known = {s for s, _, _ in semantic_map.tbox}
    if not (any(s in known or is_schema((s, p, o)) for s, p, o in triples) or find_shapes(triples)):
        raise errors.BadFile(
            f"{load.filename or 'the file'} has no axiom to extend the TBox by; to load a map leave out"
            " --tbox --extend"
        )


def require_no_map(semantic_map: SemanticMap, load: LoadDocument | LoadTBox, tbox: Iterable[Triple]) -> None:
    """Raise BadFile for a TBox that describes entities of the map, which could not be changed any more."""
    there = set(tbox_validation.described_by(semantic_map.tbox, semantic_map.classes))
    described = tbox_validation.described_by(tbox, semantic_map.classes)
    if again := [name for name in described if name not in there and semantic_map.find(name) is not None]:
        raise errors.BadFile(
            f"{load.filename or 'the file'} cannot be the TBox: it describes {wording.entities(len(again))}"
            f" of the map ({wording.few(again, 4)}); load a map without --tbox"
        )


def without_repetition(
    semantic_map: SemanticMap, transaction: Transaction, tbox: frozenset[Triple]
) -> Transaction:
    """Return a transaction that replaces the TBox by `tbox` without triples that it would not change."""
    insert = dict.fromkeys(transaction.insert)
    retract = dict.fromkeys(t for t in transaction.retract if t not in insert and t not in tbox)
    return structs.replace(
        transaction,
        insert=tuple(t for t in insert if not semantic_map.is_asserted(t)),
        retract=tuple(t for t in retract if semantic_map.is_asserted(t)),
    )


def make_tbox_transaction(
    semantic_map: SemanticMap, load: LoadTBox, tbox: frozenset[Triple]
) -> Transaction | None:
    """Return how another TBox changes the imports of the ABox, or None if it is the present TBox."""
    imports, before = tbox_validation.import_triples(tbox), tbox_validation.import_triples(semantic_map.tbox)
    transaction = _transaction(
        load,
        retract=(t for t in before if t not in imports and semantic_map.is_asserted(t)),
        insert=(t for t in imports if not semantic_map.is_asserted(t)),
    )
    imports_differ = transaction.retract or transaction.insert
    if not imports_differ and tbox == semantic_map.tbox:
        return None
    return transaction


def _transaction(
    load: LoadDocument | LoadTBox, *, retract: Iterable[Triple], insert: Iterable[Triple]
) -> Transaction:
    return Transaction(
        id=load.id,
        source=load.source,
        agent=load.agent,
        verb="load",
        reason=load.reason,
        retract=tuple(retract),
        insert=tuple(insert),
    )
