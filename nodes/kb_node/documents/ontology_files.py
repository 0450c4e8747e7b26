"""Reads ontology files with their imports, which are found by option, by a catalogue or next to them.

Nothing is fetched from the network. The files become one graph. Its imports have the names of the ontologies
that were found for them, so the graph shows which are missing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple
from urllib.parse import unquote, urlsplit

from semmap.nodes.kb_node.documents import catalogue
from semmap.nodes.kb_node.documents.isolated_parser import IsolatedParser
from semmap.nodes.kb_node.documents.rdf import Document
from semmap.ontology import vocabulary as v
from semmap.ontology.prefixes import Prefixes
from semmap.schemas import errors
from semmap.schemas.explanations import Term, Triple
from semmap.schemas.packing import unpacked

SUFFIXES = (
    ".owl", ".rdf", ".rdfs", ".ttl", ".trig", ".nt", ".nq", ".n3", ".jsonld", ".ofn", ".fss", ".omn", ".owx",
    ".xml",
)  # fmt: skip
VERSION = v.iri(f"{v.OWL}versionIRI")


class Gathered(NamedTuple):
    """The ontologies of some files with all imports that were found."""

    triples: list[Triple]
    files: tuple[Path, ...]
    """All files that were read, the named ones first."""
    found: Mapping[str, Path]
    """File by import."""
    missing: tuple[str, ...]
    """The imports without a file."""
    prefixes: Prefixes = MappingProxyType({})
    """The declared prefixes; if files differ, those of the first file."""
    notes: tuple[str, ...] = ()
    """Notes on statements that are left out, with their files."""


class Header(NamedTuple):
    """The header triples of ontologies. IRIs are terms."""

    ontologies: tuple[Term, ...]
    versions: tuple[Term, ...]
    imports: tuple[Term, ...]


def header(triples: Iterable[Triple]) -> Header:
    """Return the ontologies with their versions and imports."""
    found: dict[Term, dict[Term, None]] = {v.OWL_ONTOLOGY: {}, VERSION: {}, v.OWL_IMPORTS: {}}
    for s, p, o in triples:
        if p == v.RDF_TYPE and o == v.OWL_ONTOLOGY:
            found[v.OWL_ONTOLOGY][s] = None
        elif p in (VERSION, v.OWL_IMPORTS):
            found[p][o] = None
    return Header(*(tuple(sorted(terms)) for terms in found.values()))


def missing_imports(triples: Iterable[Triple]) -> tuple[str, ...]:
    """Return the IRIs of imports that are not in the graph."""
    ontologies, versions, imports = header(triples)
    there = {_plain(term) for term in (*ontologies, *versions)}
    return tuple(v.bare(term) for term in imports if _plain(term) not in there)


def gather(named: Sequence[Path], given: Mapping[str, Path], graph: str = "") -> Gathered:
    """Read ontologies with all imports, in any syntax. A folder stands for the ontologies in it.

    `given` maps imports to files. `graph` is the graph of the named files to read in place of the default
    graph. Raises BadFile for an unreadable file.
    """
    with IsolatedParser() as parser:
        gathering = _Gathering([path for one in named for path in _files_of(one)], given, graph, parser)
        while gathering.to_read:
            gathering.read(gathering.to_read.pop(0))
        return gathering.gathered()


class _Gathering:
    def __init__(
        self, named: Iterable[Path], given: Mapping[str, Path], graph: str, parser: IsolatedParser
    ) -> None:
        self._called = {path.resolve(): path for path in named}
        self._named = tuple(self._called)
        self.to_read = list(self._named)
        self._given = {_plain(v.iri(iri)): path for iri, path in given.items()}
        self._graph, self._parser = graph, parser
        self._parsed: dict[Path, Document] = {}
        self._read: dict[Path, Document] = {}
        self._stands_for: dict[Term, Path] = {}

    def read(self, path: Path) -> None:
        """Read a file, and queue its imports."""
        if path in self._read:
            return
        document = self._read[path] = self._document(path)
        for term in header(document.triples).imports:
            if term not in self._stands_for and (found := self._find(term, path.parent)) is not None:
                self._stands_for[term] = found
                self.to_read.append(found)

    def gathered(self) -> Gathered:
        """Return all files in one graph."""
        names = {term: self._name_of(path, term) for term, path in self._stands_for.items()}
        triples: dict[Triple, None] = {}
        for document in self._read.values():
            triples.update(
                ((s, p, names.get(o, o)) if p == v.OWL_IMPORTS else (s, p, o), None)
                for s, p, o in document.triples
            )
        for name in names.values():
            triples.setdefault((name, v.RDF_TYPE, v.OWL_ONTOLOGY))
        return Gathered(
            list(triples),
            tuple(self._read),
            {v.bare(term): path for term, path in self._stands_for.items()},
            missing_imports(triples),
            self._prefixes(),
            tuple(f"{path.name}: {note}" for path, read in self._read.items() for note in read.notes),
        )

    def _prefixes(self) -> dict[str, str]:
        declared: dict[str, str] = {}
        for document in self._read.values():
            declared = {**document.prefixes, **declared}
        return declared

    def _name_of(self, path: Path, wanted: Term) -> Term:
        """Return the ontology in a file that was found for an import, or `wanted` if there are several."""
        named = [o for o in header(self._read[path].triples).ontologies if o.startswith("<")]
        return wanted if wanted in named or not named else named[0]

    def _find(self, term: Term, folder_of_import: Path) -> Path | None:
        iri = v.bare(term)
        if (given := self._given.get(_plain(term))) is not None:
            return given.resolve()
        for path in self._named:
            if self._is(path, term):
                return path
        folders = dict.fromkeys((folder_of_import, *(path.parent for path in self._named)))
        if (at := _file_below(folders, iri)) is not None:
            return at
        for folder in folders:
            if (found := catalogue.find(folder, iri)) is not None:
                return found
        for folder in folders:
            if (found := self._find_in(folder, term)) is not None:
                return found
        return None

    def _find_in(self, folder: Path, term: Term) -> Path | None:
        """Return the file in a folder that contains the ontology, or else has its name."""
        name = unquote(_plain(term).partition("#")[0].rstrip("/").rpartition("/")[2])
        if not name:
            return None
        files = _ontologies_in(folder)
        called = [path for path in files if name in (path.name, path.stem)]
        others = [path for path in files if path not in called]
        for path in (*called, *others):
            if (path in called or name.encode() in path.read_bytes()) and self._is(path, term):
                return path.resolve()
        return called[0].resolve() if called else None

    def _is(self, path: Path, term: Term) -> bool:
        """Return whether a file contains the ontology. An unreadable file does not."""
        try:
            ontologies, versions, _ = header(self._document(path.resolve()).triples)
        except errors.BadFile:
            return False
        return _plain(term) in {_plain(o) for o in (*ontologies, *versions)}

    def _document(self, path: Path) -> Document:
        """Return the content of a file, which is parsed once."""
        if path not in self._parsed:
            name = self._called.get(path, path)
            graph = self._graph if path in self._called else ""
            self._parsed[path] = _read(name, f"t{len(self._parsed)}x", self._parser, graph)
        return self._parsed[path]


def read(path: Path, label_prefix: str = "") -> Document:
    """Return the content of a file, with `label_prefix` for its blank nodes. Raises BadFile."""
    with IsolatedParser() as parser:
        return _read(path, label_prefix, parser)


def _read(path: Path, label_prefix: str, parser: IsolatedParser, graph: str = "") -> Document:
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        raise errors.BadFile(f"there is no file {path}") from None
    except OSError as error:
        raise errors.BadFile(f"{path} cannot be read: {error.strerror}") from None
    return parser.read(unpacked(content, str(path)), str(path), label_prefix, graph=graph)


def _file_below(folders: Iterable[Path], iri: str) -> Path | None:
    """Return the file of a `file:` IRI if it is in one of these folders; other files are never read."""
    if not iri.startswith("file:"):
        return None
    path = Path(unquote(urlsplit(iri).path)).resolve()
    return path if path.is_file() and any(map(path.is_relative_to, folders)) else None


def _files_of(path: Path) -> list[Path]:
    if not path.is_dir():
        return [path]
    if not (files := _ontologies_in(path)):
        raise errors.BadFile(f"there is no ontology in the folder {path}")
    return files


def _ontologies_in(folder: Path) -> list[Path]:
    """Return the files of a folder with the suffixes of ontologies."""
    try:
        return sorted(
            path
            for path in folder.iterdir()
            if path.suffix.lower() in SUFFIXES and path.name != catalogue.FILENAME and path.is_file()
        )
    except OSError as error:
        raise errors.BadFile(f"{folder} cannot be read: {error.strerror}") from None


def _plain(term: Term) -> str:
    """Return an IRI for comparison, without a `#` or `/` at its end."""
    return v.bare(term).rstrip("#/") if term.startswith("<") else term
