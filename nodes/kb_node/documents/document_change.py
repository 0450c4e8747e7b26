"""What a file brings into the map, as a transaction."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from operator import is_

from semmap.nodes.kb_node.documents import abox_document, rdf
from semmap.nodes.kb_node.documents.tbox import tbox_declarations, tbox_validation
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.schemas import errors, wording
from semmap.schemas.bridge import LoadDocument, LoadTBox
from semmap.schemas.commits import Transaction
from semmap.schemas.explanations import Triple
from semmap.schemas.packing import unpacked


def of_document(
    semantic_map: SemanticMap, load: LoadDocument, triples: Iterable[Triple]
) -> tuple[Transaction, abox_document.SortedOut]:
    """What of an ABox may come into the map, and what is to be said of the rest.

    Raises UnknownClass, BadFile for a TBox, UnknownName for what nobody describes if the load is strict.
    """
    sorted_out = abox_document.sort_out(triples, semantic_map.classes, skip_unknown=load.skip_unknown)
    stays = semantic_map.tbox.__contains__ if load.replace else lambda _: True
    if found := abox_document.strangers(sorted_out.triples, semantic_map.reasoner, stays):
        said = abox_document.of_strangers(found)
        if load.strict:
            raise errors.UnknownName(said)
        sorted_out.notes.append(f"{said}; --strict refuses such files")
    transaction = _transaction(
        load,
        retract=semantic_map.abox() if load.replace else (),
        insert=_outside(sorted_out.triples, semantic_map.tbox),
    )
    return transaction, sorted_out


def is_all(triples: Sequence[Triple], transaction: Transaction) -> bool:
    """Is a transaction nothing but what a document says, word by word?"""
    insert = transaction.insert
    return not transaction.retract and len(insert) == len(triples) and all(map(is_, insert, triples))


def _outside(triples: list[Triple], tbox: frozenset[Triple]) -> Iterable[Triple]:
    """Those that the TBox does not say."""
    said = tbox.intersection(triples)
    return (t for t in triples if t not in said) if said else triples


def tbox_of(semantic_map: SemanticMap, load: LoadTBox, *, label_prefix: str) -> list[Triple]:
    """The triples of a TBox, with its prefixes and what is in space; of an extension those that it adds.

    The present TBox's declared spatial roots stay until others are declared.
    Raises BadFile, UnknownClass.
    """
    content = unpacked(load.content, load.filename)
    parsed = rdf.parse(content, load.filename, label_prefix=label_prefix)
    if load.extend:
        _require_schema(semantic_map, load, parsed)
        return tbox_declarations.extension(
            parsed,
            semantic_map.tbox,
            semantic_map.classes,
            of_file=rdf.prefixes(content),
            spatial_root=load.spatial_root,
        )
    triples = tbox_declarations.declared(
        parsed, of_file=rdf.prefixes(content), spatial_root=load.spatial_root
    )
    return triples if load.spatial_root else tbox_declarations.keeping_roots(triples, semantic_map.classes)


def _require_schema(semantic_map: SemanticMap, load: LoadTBox, triples: Iterable[Triple]) -> None:
    """Raises BadFile for a file that neither has an axiom nor describes a term of the present TBox."""
    known = {s for s, _, _ in semantic_map.tbox}
    if not any(s in known or is_schema((s, p, o)) for s, p, o in triples):
        raise errors.BadFile(
            f"{load.filename or 'the file'} has no axiom to extend the TBox by; to load a map leave out"
            " --tbox --extend"
        )


def require_no_map(semantic_map: SemanticMap, load: LoadTBox, tbox: Iterable[Triple]) -> None:
    """Raises BadFile for a TBox that describes what the map has: as a part of it nothing could be changed."""
    there = set(tbox_validation.described_by(semantic_map.tbox, semantic_map.classes))
    described = tbox_validation.described_by(tbox, semantic_map.classes)
    if again := [name for name in described if name not in there and semantic_map.find(name) is not None]:
        raise errors.BadFile(
            f"{load.filename or 'the file'} cannot be the TBox: it describes {wording.entities(len(again))}"
            f" of the map ({wording.few(again, 4)}); load a map without --tbox"
        )


def of_tbox(semantic_map: SemanticMap, load: LoadTBox, tbox: frozenset[Triple]) -> Transaction | None:
    """What another TBox changes of the ABox: its imports. None if it is the one that holds."""
    imports, before = tbox_validation.imports(tbox), tbox_validation.imports(semantic_map.tbox)
    transaction = _transaction(
        load,
        retract=(t for t in before if t not in imports and semantic_map.has(t)),
        insert=(t for t in imports if not semantic_map.has(t)),
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
