"""XML catalogues, as written by Protégé next to an ontology: they map imports to files."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote, urlsplit
from xml.etree import ElementTree

from semmap.schemas import errors
from semmap.schemas.nesting import require_shallow_xml

FILENAME = "catalog-v001.xml"
_SPACE = "{urn:oasis:names:tc:entity:xmlns:xml:catalog}"
_BASE = "{http://www.w3.org/XML/1998/namespace}base"


def find(folder: Path, iri: str) -> Path | None:
    """Return the file that the catalogue of a folder lists for an ontology, if it exists.

    Raises BadFile for a catalogue that is not valid XML.
    """
    return _find(folder / FILENAME, iri, set())


def _find(catalogue: Path, iri: str, seen: set[Path]) -> Path | None:
    if catalogue in seen or not catalogue.is_file():
        return None
    seen.add(catalogue)
    try:
        content = catalogue.read_bytes()
        require_shallow_xml(content)
        root = ElementTree.fromstring(content)
    except OSError as error:
        raise errors.BadFile(f"{catalogue} cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise errors.BadFile(f"{catalogue} is not a valid XML catalogue: {error}") from None
    entries = list(_entries(root, catalogue.parent))
    for entry, folder in entries:
        if (path := _path_of(entry, folder, iri)) is not None and path.is_file():
            return path
    for entry, folder in entries:
        if entry.tag == f"{_SPACE}nextCatalog":
            further = _path(folder, entry.get("catalog", ""))
            if further is not None and (path := _find(further, iri, seen)) is not None:
                return path
    return None


def _entries(element: ElementTree.Element, folder: Path) -> Iterator[tuple[ElementTree.Element, Path]]:
    """Yield the entries of a catalogue and its groups, with the base folder of their paths."""
    folder = _path(folder, element.get(_BASE, "")) or folder
    for child in element:
        yield child, folder
        yield from _entries(child, folder)


def _path_of(entry: ElementTree.Element, folder: Path, iri: str) -> Path | None:
    if entry.tag in (f"{_SPACE}uri", f"{_SPACE}system"):
        name = entry.get("name", entry.get("systemId"))
        return _path(folder, entry.get("uri", "")) if name == iri else None
    start = entry.get("uriStartString", entry.get("systemIdStartString"))
    if entry.tag in (f"{_SPACE}rewriteURI", f"{_SPACE}rewriteSystem") and start and iri.startswith(start):
        return _path(folder, entry.get("rewritePrefix", "") + iri[len(start) :])
    return None


def _path(folder: Path, uri: str) -> Path | None:
    """Return the path of a relative reference or file URI, or None for other URIs."""
    parts = urlsplit(uri)
    if parts.scheme not in ("", "file") or parts.netloc not in ("", "localhost"):
        return None
    return (folder / unquote(parts.path)).resolve()
