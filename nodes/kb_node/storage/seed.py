"""A new journal from ontology files, checked before anything on disk is touched."""

from __future__ import annotations

import os
import uuid
from collections.abc import Mapping, Sequence
from datetime import datetime
from pathlib import Path
from types import MappingProxyType

from semmap.nodes.kb_node.documents import abox_document, ontology_files, rdf
from semmap.nodes.kb_node.documents.tbox import tbox_declarations, tbox_validation
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.sparql.triples.kept import forget
from semmap.nodes.kb_node.storage import closure_cache
from semmap.nodes.kb_node.storage.existing_map import existing_map
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.kb_node.storage.journal.sqlite_file import InUse
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
    fresh: bool = False,
) -> str:
    """Make the journal of folder `data` from a TBox and an ABox file; say what was done.

    The TBox may be in several files and folders; `imports` says in which file an imported ontology is,
    `spatial_root` which of its classes are of things in space, where that is not known by itself.
    A journal that is there already wins and stays as it is, unless `fresh`: then it is moved to
    `data/kept/<time>/`. Raises BadFile, UnknownClass or Inconsistent with existing data untouched.
    """
    path = data / FILENAME
    if not fresh and (told := existing_map(data)) is not None:
        return told  # an unreadable one is reported before anything starts
    tboxes = (tbox,) if isinstance(tbox, Path) else tuple(tbox)
    name = ", ".join(map(str, tboxes))
    gathered = ontology_files.gather(tboxes, imports)
    tbox_triples = tbox_declarations.declared(
        gathered.triples, of_file=gathered.prefixes, spatial_root=spatial_root, files=tboxes
    )
    reasoner = tbox_validation.compiled(tbox_triples, name)
    closed = reasoner.closed  # as it is before the ABox may add to the schema
    abox_triples = [(v.ABOX_ONTOLOGY, v.RDF_TYPE, v.OWL_ONTOLOGY), *tbox_validation.imports(tbox_triples)]
    notes: list[str] = []
    if abox is not None:
        said = ontology_files.read(abox, "a")
        try:
            sorted_out = abox_document.sort_out(said, ClassTable(reasoner), skip_unknown=False)
        except errors.UnknownClass as error:
            text = error.text.removesuffix(errors.SKIP_UNKNOWN)
            raise type(error)(
                f"{abox}: {text}; other classes are given with --tbox FILE, another map with --abox FILE|none"
            ) from None
        except errors.BadRequest as error:
            raise type(error)(f"{abox}: {error.text}") from None
        abox_triples += sorted_out.triples
        notes = sorted_out.notes
        if found := abox_document.strangers(sorted_out.triples, reasoner):
            notes.append(abox_document.of_strangers(found))
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
        size = _make(new, tbox_triples, reasoner, transaction)
        put_in_place(new, path)
        closure_cache.keep(closed, tbox_triples, data)
    except (errors.Inconsistent, errors.BadRequest) as error:
        raise type(error)(f"{abox or name}: {error.text}", explanation=error.explanation) from None
    except OSError as error:
        raise errors.Refused(f"cannot keep a map in {data}: {error.strerror}") from None
    return "; note: ".join((f"{wording.entities(size)}{source}", *notes))


def _make(path: Path, tbox: list[Triple], reasoner: Reasoner, transaction: Transaction) -> int:
    """A journal at `path` with one commit; how many entities that makes. After an error nothing is there."""
    remove(path)
    try:
        journal = Journal.create(path, rdf.serialise(tbox, "ntriples"))
        try:
            semantic_map = SemanticMap(journal, reasoner=reasoner)
            semantic_map.commit(transaction)
            semantic_map.checkpoint()
        finally:
            journal.close()
    except errors.SemmapError:
        remove(path)
        raise
    return len(semantic_map)


def require_unused(path: Path) -> None:
    """Raises Refused when a knowledge base is at work on the journal; a damaged one may be set aside."""
    if path.exists():
        try:
            Journal(path).close()
        except InUse:
            raise
        except errors.Refused:
            return


def put_in_place(new: Path, path: Path) -> Path | None:
    """Let the journal `new` take the place of the one at `path`; where that is kept now, if there was one."""
    kept = set_aside(path.parent)
    new.rename(path)
    _sync(path.parent)
    return kept


def _sync(folder: Path) -> None:
    """Make a renaming in `folder` durable."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def set_aside(data: Path) -> Path | None:
    """Move a present journal out of the way, for whoever may want it back; where to."""
    present = [p for p in data.glob(f"{FILENAME}*") if p.is_file()]
    if not present:
        return None
    kept = data / KEPT / f"{datetime.now():%Y-%m-%dT%H-%M-%S.%f}"
    kept.mkdir(parents=True, exist_ok=True)
    for p in present:
        p.rename(kept / p.name)
    forget(data)
    return kept


def remove(path: Path) -> None:
    """Delete a journal that is not used yet."""
    for p in path.parent.glob(f"{path.name}*"):
        p.unlink()
