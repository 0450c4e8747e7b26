"""Ontologies of whoever asks, with what they import: the system reads no files of its clients."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from semmap.nodes.extern.files import read_file
from semmap.nodes.runtime import extras


def ontology(path: Path, imports: Mapping[str, str | Path]) -> tuple[bytes, str]:
    """A document with an ontology and all that it imports, as far as that is found, and what it is called.

    `imports` says in which file an import is. The document is the file itself where there is only that one,
    and else of N-Triples. Where only a client is installed, a file is taken without its imports, as nothing
    there can read it. Raises BadFile, and BadRequest for what that client cannot do.
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
