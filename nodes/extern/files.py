"""Files of the client: read whole or refused in one sentence, written atomically."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

import msgspec

from semmap.schemas import errors
from semmap.schemas.packing import LARGEST


def read_file(path: Path) -> bytes:
    """The content of a file. Raises BadFile in one sentence when there is none, or no end of it."""
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
    """From a detector's labels to classes, as a JSON file has them. Raises BadFile."""
    try:
        return msgspec.json.decode(read_file(path), type=dict[str, str])
    except msgspec.DecodeError:
        raise errors.BadFile(
            f'{path} is no map of labels to classes, such as {{"coffee mug": "Cup"}}'
        ) from None


def write_atomically(file: Path, content: bytes) -> None:
    """All of `content` under that name, or nothing; into what is no file, such as a pipe, it is just written.

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
