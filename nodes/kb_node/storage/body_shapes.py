"""The file with the shapes of bodies of world files, for starts without the simulator and past states."""

from __future__ import annotations

import logging
import os
import shutil
from contextlib import suppress
from pathlib import Path
from typing import Final

import msgspec

from semmap.nodes.kb_node.storage.journal.layout import FILENAME as JOURNAL
from semmap.ontology.model_shapes import WorldShapes, exchange_world
from semmap.schemas import errors

log = logging.getLogger(__name__)

_SUFFIX: Final = ".shapes"
FILENAME: Final = f"{JOURNAL}{_SUFFIX}"
"""Beside the journal, with which it is archived if a new map is started."""


def beside(journal: Path) -> Path:
    """Return the file with the shapes that belong to a journal."""
    return journal.with_name(f"{journal.name}{_SUFFIX}")


def load(file: Path) -> str:
    """Use the stored shapes, if any, and return the error text if they cannot be read, else ""."""
    found, problem = WorldShapes(), ""
    try:
        found = msgspec.json.decode(file.read_bytes(), type=WorldShapes)
    except FileNotFoundError:
        pass
    except (OSError, msgspec.DecodeError) as error:
        log.warning("%s: %s", file, error)
        problem = (
            f"{file.name} cannot be read; relations use the models of classes until sim_node sends shapes"
        )
    exchange_world(found)
    return problem


def read(file: Path) -> tuple[int, bytes]:
    """Return the time of the file [ns] and its content; 0 and nothing without a file."""
    try:
        with file.open("rb") as opened:  # which stays the same one if another replaces it
            return os.fstat(opened.fileno()).st_mtime_ns, opened.read()
    except FileNotFoundError:
        return 0, b""


def copy(source: Path, target: Path) -> None:
    """Copy the shapes of one data folder to another one, if there are any."""
    if (file := source / FILENAME).is_file():
        shutil.copyfile(file, target / FILENAME)


def write(file: Path, shapes: WorldShapes) -> None:
    """Write the shapes completely or not at all. Raises Refused."""
    beside = file.with_name(f"{file.name}.partly")
    try:
        beside.write_bytes(msgspec.json.encode(shapes))
        beside.replace(file)
    except OSError as error:
        with suppress(OSError):
            beside.unlink()
        raise errors.Refused(
            f"{file} cannot be written: {error.strerror}; free space and restart the system"
        ) from None
