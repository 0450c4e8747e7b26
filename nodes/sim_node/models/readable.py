"""Restricts the files of models to configured folders.

The name of a model comes from the map, which other users may change.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator, Sequence
from pathlib import Path

from semmap.nodes.runtime.pictures import require_small_png
from semmap.nodes.sim_node.models.library import ModelError
from semmap.schemas.nesting import NotWellFormed, require_shallow_xml

_FOLDERS = ("meshdir", "texturedir", "assetdir")
_MJCF = ("include", "model")
"""Elements whose files refer to further files; a model is attached to bodies."""
LARGEST_FILE_BYTES = 64 << 20
_DEEPEST = 20
"""Maximum number of files that include one another."""


def require_readable(path: Path, roots: Sequence[Path]) -> None:
    """Raise ModelError for a path outside all `roots` (after resolving links), or to a pipe or device.

    Reading these might never end.
    """
    real = path.resolve()
    if not any(real.is_relative_to(root.resolve()) for root in roots):
        where = " or ".join(map(str, roots)) or "the folder given by `semmap up --models DIR`"
        raise ModelError(f"cannot read model file {path}: only files in {where} are allowed")
    if real.exists() and not (real.is_file() or real.is_dir()):
        raise ModelError(f"cannot read model file {path}: not a regular file")


def require_references(path: Path, roots: Sequence[Path]) -> None:
    """Check the same for all files that an MJCF file includes or refers to. MuJoCo rejects invalid XML.

    Raises ModelError, OSError.
    """
    folders, files = {path.parent}, [path]
    for depth, file in enumerate(files):  # the list grows in the loop
        if depth > _DEEPEST:
            raise ModelError(f"model file {path} includes more than {_DEEPEST} files")
        if file.stat().st_size > LARGEST_FILE_BYTES:
            raise ModelError(f"model file {file} is larger than {LARGEST_FILE_BYTES >> 20} MB")
        content = file.read_bytes()
        try:
            require_shallow_xml(content)
        except NotWellFormed:
            continue
        except ValueError as error:
            raise ModelError(f"cannot use model file {file}: {error}") from None
        root = ElementTree.fromstring(content)
        folders.add(file.parent)
        folders.update(file.parent / value for value in _values(root, _FOLDERS))
        for folder in folders:
            require_readable(folder, roots)
        for element in root.iter():
            for name in _values(element, ("file", *(k for k in element.attrib if k.startswith("file")))):
                for there in (folder / name for folder in folders):
                    require_readable(there, roots)
                    _require_small(there)
                    if element.tag in _MJCF and there.is_file():
                        files.append(there)


def _require_small(path: Path) -> None:
    """Raise ModelError for a texture that is too large to decode, OSError."""
    try:
        if path.is_file():
            require_small_png(path)
    except ValueError as error:
        raise ModelError(f"cannot use texture {path}: {error}") from None


def _values(element: ElementTree.Element, names: Sequence[str]) -> Iterator[str]:
    """Return the values of these attributes, for folders those of all `compiler` elements."""
    elements = element.iter("compiler") if names is _FOLDERS else (element,)
    for one in elements:
        yield from (value for name in dict.fromkeys(names) if (value := one.get(name)))
