"""Creation of a journal from ontology files, which are checked before anything on disk changes."""

from __future__ import annotations

import os
import uuid
from collections.abc import Mapping, Sequence
from datetime import datetime
from pathlib import Path
from types import MappingProxyType

from semmap.nodes.kb_node.documents import abox_document, ontology_files, rdf
from semmap.nodes.kb_node.documents.tbox import map_declarations, tbox_declarations, tbox_validation
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.shacl import violations
from semmap.nodes.kb_node.shacl.enforcement import ShapeEnforcement
from semmap.nodes.kb_node.sparql.triples.disk_stores import forget
from semmap.nodes.kb_node.storage import body_shapes, closure_cache
from semmap.nodes.kb_node.storage.existing_map import describe_existing_map
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.kb_node.storage.journal.sqlite_file import InUse
from semmap.nodes.runtime.isolated_process import limited
from semmap.ontology import vocabulary as v
from semmap.schemas import errors, wording
from semmap.schemas.commits import Transaction
from semmap.schemas.explanations import Triple

KEPT = "kept"


def seed(
    data: Path,
    tbox: Path | Sequence[Path],
    abox: Path | None,
    *,
    imports: Mapping[str, Path] = MappingProxyType({}),
    spatial_root: Sequence[str] = (),
    skip_unknown: bool = False,
    tbox_from_abox: bool = False,
    fresh: bool = False,
    enforce_shapes: bool = False,
) -> str:
    """Create the journal of folder `data` from a TBox and an ABox file, and return a summary.

    The TBox may consist of several files and folders. `imports` maps imported ontologies to files.
    `spatial_root` names the classes of spatial things, if they cannot be detected. With `skip_unknown`, the
    individuals of unknown classes are left out. With `tbox_from_abox`, the classes and properties that the
    ABox file declares become part of the TBox. With `enforce_shapes`, files that violate a SHACL shape of the
    TBox, or whose shapes are invalid, are rejected. An existing journal is kept and used, unless `fresh`:
    then it is moved to `data/kept/<time>/`. Raises BadFile, UnknownClass or Inconsistent, with existing data
    unchanged.
    """
    path = data / FILENAME
    if not fresh and (notice := describe_existing_map(data)) is not None:
        return notice  # an unreadable journal is reported before anything starts
    tboxes = (tbox,) if isinstance(tbox, Path) else tuple(tbox)
    name = ", ".join(map(str, tboxes))
    with limited():
        gathered = ontology_files.gather(tboxes, imports)
    document = None if abox is None else ontology_files.read(abox, "a")
    with limited():
        of_tbox, prefixes = gathered.triples, gathered.prefixes
        if document is not None and tbox_from_abox:
            split = map_declarations.split_declarations(document.triples, of_tbox)
            of_tbox, prefixes = [*of_tbox, *split.declared], {**document.prefixes, **prefixes}
            document = document._replace(
                triples=split.others,
                notes=(
                    *document.notes,
                    map_declarations.describe(set(split.declared).difference(gathered.triples)),
                ),
            )
        tbox_triples = tbox_declarations.with_declarations(
            of_tbox, of_file=prefixes, spatial_root=spatial_root, files=tboxes
        )
        reasoner = tbox_validation.compile_tbox(tbox_triples, name)
    closed = reasoner.closed  # before the ABox may add to the schema
    abox_triples = [
        (v.ABOX_ONTOLOGY, v.RDF_TYPE, v.OWL_ONTOLOGY),
        *tbox_validation.import_triples(tbox_triples),
    ]
    notes = [*gathered.notes]
    if abox is not None and document is not None:
        try:
            filtered = abox_document.filter_document(
                document.triples,
                ClassTable(reasoner),
                skip_unknown=skip_unknown,
                of_file=abox_document.DocumentOrigin(abox.name),
            )
        except errors.UnknownClass as error:
            text = error.text.removeprefix(f"{abox.name}: ")
            raise type(error)(
                f"{abox}: {text}; other classes are given with --tbox FILE, another map with --abox FILE|none"
            ) from None
        except errors.BadRequest as error:
            raise type(error)(f"{abox}: {error.text.removeprefix(f'{abox.name}: ')}") from None
        abox_triples += filtered.triples
        notes += [*document.notes, *filtered.notes]
        if filtered.skipped:
            notes.append(f"left out {len(filtered.skipped)}: {wording.few(filtered.skipped, 5)}")
        if found := abox_document.find_undescribed(filtered.triples, reasoner):
            notes.append(abox_document.undescribed_note(found))
    source = f" from {abox.name}" if abox is not None else ""
    transaction = Transaction(
        id=f"seed-{uuid.uuid4().hex}",
        source="file",
        reason=f"begun{source}" if source else "begun empty",
        insert=tuple(abox_triples),
    )
    try:
        data.mkdir(parents=True, exist_ok=True)
        require_unused(path)
        new = path.with_name(f"new-{FILENAME}")
        semantic_map = _make(new, tbox_triples, reasoner, transaction, enforce_shapes=enforce_shapes)
        install_journal(new, path)
        closure_cache.save(closed, tbox_triples, data)
    except (errors.Inconsistent, errors.BadRequest) as error:
        raise type(error)(f"{abox or name}: {error.text}", explanation=error.explanation) from None
    except OSError as error:
        raise errors.Refused(f"cannot create a map in {data}: {error.strerror}") from None
    notes += abox_document.name_notes(semantic_map.entities())
    return "; note: ".join((f"{wording.entities(len(semantic_map))}{source}", *notes))


def _make(
    path: Path,
    tbox: list[Triple],
    reasoner: Reasoner,
    transaction: Transaction,
    *,
    enforce_shapes: bool = False,
) -> SemanticMap:
    """Create a journal at `path` with one commit, and return its map. The journal is closed.

    Nothing is left after an error.
    """
    delete_journal(path)
    try:
        journal = Journal.create(path, rdf.serialise(tbox, "ntriples"))
        try:
            semantic_map = SemanticMap(journal, reasoner=reasoner)
            semantic_map.commit(transaction)
            if enforce_shapes:
                _require_valid(semantic_map)
            semantic_map.checkpoint()
        finally:
            journal.close()
    except errors.SemmapError:
        delete_journal(path)
        raise
    return semantic_map


def _require_valid(semantic_map: SemanticMap) -> None:
    """Raise BadFile if a shape of the TBox is invalid, or the map violates one."""
    semantic_map.derive_all()
    with limited():
        enforcement = ShapeEnforcement(semantic_map.tbox)
        found = enforcement.find_violations(None, semantic_map.reasoner)
    if found:
        raise errors.BadFile(
            f"{violations.describe_rejection(found, semantic_map)}; to start with this map and repair it,"
            " omit --enforce-shapes"
        )


def require_unused(path: Path) -> None:
    """Raise Refused if a knowledge base uses the journal. A damaged one may be replaced."""
    if path.exists():
        try:
            Journal(path).close()
        except InUse:
            raise
        except errors.Refused:
            return


def install_journal(new: Path, path: Path) -> Path | None:
    """Replace the journal at `path` by `new`, and return where the old one is kept, if there was one.

    Shapes beside the new journal go with it.
    """
    kept = archive_journal(path.parent)
    if (shapes := body_shapes.beside(new)).exists():
        shapes.rename(body_shapes.beside(path))
    new.rename(path)
    _sync(path.parent)
    return kept


def _sync(folder: Path) -> None:
    """Make a rename in `folder` durable."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def archive_journal(data: Path) -> Path | None:
    """Move an existing journal to a folder for old ones, and return that folder."""
    present = [p for p in data.glob(f"{FILENAME}*") if p.is_file()]
    if not present:
        return None
    kept = data / KEPT / f"{datetime.now():%Y-%m-%dT%H-%M-%S.%f}"
    kept.mkdir(parents=True, exist_ok=True)
    for p in present:
        p.rename(kept / p.name)
    forget(data)
    return kept


def delete_journal(path: Path) -> None:
    """Delete a journal that is not in use."""
    for p in path.parent.glob(f"{path.name}*"):
        p.unlink()
