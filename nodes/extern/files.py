"""Local files of the client: reading with a size limit, ontologies with their imports, and atomic writing."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import msgspec

from semmap.nodes.runtime import extras
from semmap.schemas import codec, errors
from semmap.schemas.packing import LARGEST

BAG_SUFFIXES: Final = (".bag", ".db3", ".mcap")


def is_bag(path: Path) -> bool:
    """Return whether a path is a bag, by its suffix, or a rosbag2 folder."""
    return path.suffix.lower() in BAG_SUFFIXES or (path / "metadata.yaml").exists()


def read_file(path: Path, *, largest: int | None = None) -> bytes:
    """Return the content of a file of at most `largest` bytes, or `LARGEST`.

    Raises BadFile if it cannot be read or is too large.
    """
    largest = LARGEST if largest is None else largest
    try:
        with path.open("rb") as file:
            content = file.read(largest + 1)
    except FileNotFoundError:
        raise errors.BadFile(f"there is no file {path}") from None
    except IsADirectoryError:
        raise errors.BadFile(f"{path} is a directory, not a file") from None
    except OSError as error:
        raise errors.BadFile(f"{path} cannot be read: {error.strerror}") from None
    if len(content) > largest:
        raise errors.BadFile(f"{path} is larger than {largest >> 20} MiB; split it into several files")
    return content


def read_label_map(path: Path, of: str = "labels", example: str = "coffee mug") -> dict[str, str]:
    """Return the classes by label of a detector, or by name of a body, from a JSON file. Raises BadFile."""
    try:
        return msgspec.json.decode(codec.decode_text(read_file(path)), type=dict[str, str])
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        raise errors.BadFile(
            f'{path} is not a JSON object of {of} and classes, such as {{"{example}": "Cup"}}'
        ) from None


def write_atomically(file: Path, content: bytes) -> None:
    """Write a file completely or not at all. Another target, such as a pipe, is written directly.

    Raises BadFile.
    """
    import tempfile

    file = file.resolve()
    try:
        if file.exists() and not file.is_file():
            file.write_bytes(content)
            return
        with tempfile.NamedTemporaryFile(dir=file.parent, delete=False) as temporary:
            temporary.write(content)
            temporary.flush()
            os.fsync(temporary.fileno())
        Path(temporary.name).chmod(0o644)
        Path(temporary.name).replace(file)
    except OSError as error:
        with contextlib.suppress(OSError, UnboundLocalError):
            Path(temporary.name).unlink()
        raise errors.BadFile(f"{file} cannot be written: {error.strerror}") from None


def read_ontology(path: Path, imports: Mapping[str, str | Path], graph: str = "") -> tuple[bytes, str, str]:
    """Return a document with an ontology and the imports that are found, its name, and its graph to load.

    `imports` has the files of imported IRIs. Without imports, the document is the file itself; otherwise it
    is in N-Triples. If only the client is installed, the file is returned without its imports, because it
    cannot be parsed. `graph` is the graph of the file to load. Raises BadFile, also for statements that would
    be left out without a note, and BadRequest for options that need the extra `kb`.
    """
    if extras.missing(["kb"]) and not imports and not path.is_dir():
        return read_file(path), path.name, graph
    extras.require("finding imports", "kb")
    from semmap.nodes.kb_node.documents import ontology_files, rdf
    from semmap.ontology.prefixes import declarations

    gathered = ontology_files.gather([path], {iri: Path(file) for iri, file in imports.items()}, graph)
    further = len(gathered.files) - 1
    if not further:
        return read_file(gathered.files[0]), path.name, graph
    if gathered.notes:
        raise errors.BadFile(f"{gathered.notes[0]}; save its ontology as Turtle")
    more = "1 more file" if further == 1 else f"{further} more files"
    name = path.resolve().name
    triples = [*gathered.triples, *declarations(gathered.prefixes, gathered.triples)]
    return rdf.serialise(triples, "ntriples"), f"{name} and {more}", ""
