"""Ontologies with their imports, combined by the client: the system does not read files of its clients."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from semmap.nodes.extern.files import read_file
from semmap.nodes.runtime import extras


def ontology(path: Path, imports: Mapping[str, str | Path]) -> tuple[bytes, str]:
    """Return a document with an ontology and the imports that are found, and a name for it.

    `imports` has the files of imported IRIs. Without imports, the document is the file itself; otherwise it
    is in N-Triples. If only the client is installed, the file is returned without its imports, because it
    cannot be parsed. Raises BadFile, and BadRequest for options that need the extra `kb`.
    """
    if extras.missing(["kb"]) and not imports and not path.is_dir():
        return read_file(path), path.name
    extras.require("finding imports", "kb")
    from semmap.nodes.kb_node.documents import ontology_files, rdf
    from semmap.ontology.prefixes import declarations

    gathered = ontology_files.gather([path], {iri: Path(file) for iri, file in imports.items()})
    further = len(gathered.files) - 1
    if not further:
        return read_file(gathered.files[0]), path.name
    more = "1 more file" if further == 1 else f"{further} more files"
    name = path.resolve().name
    triples = [*gathered.triples, *declarations(gathered.prefixes, gathered.triples)]
    return rdf.serialise(triples, "ntriples"), f"{name} and {more}"
