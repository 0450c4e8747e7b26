"""Which files a model may be made of: those of the folders that whoever runs the system has named.

The name of a model comes from the map, which others may change.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator, Sequence
from pathlib import Path

from semmap.nodes.sim_node.models.library import ModelError

_FOLDERS = ("meshdir", "texturedir", "assetdir")
_DEEPEST = 20
"""Files that include one another."""


def require_readable(path: Path, roots: Sequence[Path]) -> None:
    """Raises ModelError for a path that leads outside all `roots`, by whatever links, or to a pipe or device.

    Reading those might never end.
    """
    real = path.resolve()
    if not any(real.is_relative_to(root.resolve()) for root in roots):
        where = " or ".join(map(str, roots)) or "the folder given by `semmap up --models DIR`"
        raise ModelError(f"the model file {path} is not read: only files in {where} may be read")
    if real.exists() and not (real.is_file() or real.is_dir()):
        raise ModelError(f"the model file {path} is not read: it is a pipe or a device, not a file")


def require_references(path: Path, roots: Sequence[Path]) -> None:
    """The same for all that an MJCF file includes or refers to. What is no XML is left to MuJoCo to refuse.

    Raises ModelError, OSError.
    """
    folders, files = {path.parent}, [path]
    for depth, file in enumerate(files):  # grows meanwhile
        if depth > _DEEPEST:
            raise ModelError(f"the model file {path} includes more than {_DEEPEST} files")
        try:
            root = ElementTree.fromstring(file.read_bytes())
        except ElementTree.ParseError:
            continue
        folders.update(file.parent / value for value in _values(root, _FOLDERS))
        for folder in folders:
            require_readable(folder, roots)
        for element in root.iter():
            for name in _values(element, ("file", *(k for k in element.attrib if k.startswith("file")))):
                for there in (folder / name for folder in folders):
                    require_readable(there, roots)
                    if element.tag == "include" and there.is_file():
                        files.append(there)


def _values(element: ElementTree.Element, names: Sequence[str]) -> Iterator[str]:
    """Those of attributes of this element, or for folders of all its `compiler` elements."""
    elements = element.iter("compiler") if names is _FOLDERS else (element,)
    for one in elements:
        yield from (value for name in dict.fromkeys(names) if (value := one.get(name)))
