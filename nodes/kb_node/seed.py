"""A new journal from ontology files, checked before anything on disk is touched."""

from __future__ import annotations

import time
from pathlib import Path

from nodes.kb_node import documents, rdf_files
from nodes.kb_node.classes import ClassTable
from nodes.kb_node.journal import FILENAME, Journal
from nodes.kb_node.reasoner import Inconsistent, Reasoner
from nodes.kb_node.semantic_map import SemanticMap
from ontology import vocabulary as v
from schemas import errors
from schemas.commits import Transaction
from schemas.explanations import Triple

KEPT = "kept"


def seed(data: Path, tbox: Path, abox: Path | None, *, fresh: bool = False) -> str:
    """Make the journal of folder `data` from a TBox and an ABox file; say what was done.

    A journal that is there already wins and stays as it is, unless `fresh`: then it is moved to
    `data/kept/<time>/`. Raises BadFile or Inconsistent with existing data untouched.
    """
    path = data / FILENAME
    if path.exists() and not fresh:
        return f"going on with the map in {data} (--fresh begins anew and keeps the old one aside)"
    tbox_triples = read_triples(tbox)
    try:
        reasoner = Reasoner(tbox_triples)
    except Inconsistent as error:
        raise errors.Inconsistent(
            f"the TBox {tbox} is inconsistent: {error.explanation.text}", explanation=error.explanation
        ) from None
    classes = ClassTable(reasoner)
    if not classes.spatial:
        raise errors.BadFile(
            f"{tbox} has no class of things in space: is it a TBox (an OWL ontology with classes)?"
        )
    abox_triples = [(v.ABOX_ONTOLOGY, v.RDF_TYPE, v.OWL_ONTOLOGY), *_imports(tbox_triples)]
    if abox is not None:
        kept, _ = documents.sort_out(read_triples(abox), classes, skip_unknown=False)
        abox_triples += kept
    data.mkdir(parents=True, exist_ok=True)
    new = path.with_name(f"new-{FILENAME}")
    _remove(new)
    journal = Journal.create(new, rdf_files.serialise(tbox_triples, "ntriples"))
    try:
        semantic_map = SemanticMap(journal, tbox_triples)
        source = str(abox.name) if abox is not None else "nothing"
        semantic_map.commit(
            Transaction(id="seed", source="file", reason=f"begun from {source}", insert=tuple(abox_triples))
        )
        semantic_map.checkpoint()
    except errors.SemmapError as error:
        raise type(error)(f"{abox}: {error.text}", explanation=error.explanation) from None
    finally:
        journal.close()
    set_aside(data)
    new.rename(path)
    return f"{len(semantic_map)} entities from {source}"


def set_aside(data: Path) -> None:
    """Move a present journal out of the way, for whoever may want it back."""
    present = [p for p in data.glob(f"{FILENAME}*") if p.is_file()]
    if present:
        kept = data / KEPT / time.strftime("%Y-%m-%dT%H-%M-%S")
        kept.mkdir(parents=True, exist_ok=True)
        for p in present:
            p.rename(kept / p.name)


def read_triples(path: Path) -> list[Triple]:
    """The triples of a file. Raises BadFile."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise errors.BadFile(f"{path} cannot be read: {error.strerror}") from None
    return rdf_files.parse(content, str(path), label_prefix=path.stem)


def _imports(tbox: list[Triple]) -> list[Triple]:
    """`owl:imports` of the TBox: it is resolved to the loaded file, never to the network."""
    ontologies = sorted(s for s, p, o in tbox if p == v.RDF_TYPE and o == v.OWL_ONTOLOGY)
    return [(v.ABOX_ONTOLOGY, v.OWL_IMPORTS, iri) for iri in ontologies]


def _remove(path: Path) -> None:
    for p in path.parent.glob(f"{path.name}*"):
        p.unlink()
