"""Local files of the client: reading with a size limit, and atomic writing."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

import msgspec

from semmap.schemas import errors
from semmap.schemas.packing import LARGEST


def read_file(path: Path) -> bytes:
    """Return the content of a file. Raises BadFile if it cannot be read or is too large."""
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST + 1)
    except FileNotFoundError:
        raise errors.BadFile(f"there is no file {path}") from None
    except IsADirectoryError:
        raise errors.BadFile(f"{path} is a directory, not a file") from None
    except OSError as error:
        raise errors.BadFile(f"{path} cannot be read: {error.strerror}") from None
    if len(content) > LARGEST:
        raise errors.BadFile(f"{path} is larger than {LARGEST >> 20} MiB; split it into several files")
    return content


def read_label_map(path: Path) -> dict[str, str]:
    """Return the classes by label of a detector, from a JSON file. Raises BadFile."""
    try:
        return msgspec.json.decode(read_file(path), type=dict[str, str])
    except (msgspec.DecodeError, RecursionError):
        raise errors.BadFile(
            f'{path} is not a JSON object of labels and classes, such as {{"coffee mug": "Cup"}}'
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
