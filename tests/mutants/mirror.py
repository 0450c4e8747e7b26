"""Maps a module to its own tests."""

from __future__ import annotations

import ast
import functools
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath


@dataclass(frozen=True)
class OwnTests:
    """The files of tests that a change of a module is tried against."""

    files: tuple[str, ...]
    """From the root of the repository."""
    is_mirrored: bool
    """Whether there is a file for this module; else, they are those of its folder."""
    wider: tuple[tuple[str, ...], ...] = ()
    """Further files, in groups, which are tried one after the other if no earlier one detects the change."""

    @property
    def groups(self) -> tuple[tuple[str, ...], ...]:
        """All files, in the order in which they are tried."""
        return (self.files, *self.wider) if self.files else self.wider


def find_own_tests(root: Path, module: str) -> OwnTests:
    """Return the tests of `module`, a path from `root`.

    These are `tests/a/b/test_c.py` for `nodes/a/b/c.py`. If there is no such file, it is looked for in the
    folders above, up to `tests/a`. If there is none either, they are the files of the nearest folder that has
    any, with the one that is named like the folder: `tests/a/b/test_*.py` and `tests/a/test_b.py`.

    Wider tests are those of the folder, those of the folders above it below `tests/a`, and all those below
    `tests/a` that import the module.
    """
    path = PurePosixPath(module)
    folders = _folders(path)
    near = {folder: found for folder in folders if (found := _list_tests(root, folder))}
    nearest, *above = (*near.values(), ()) if folders[-1] not in near else near.values()
    above = above[:-1]  # those of the whole node take too long
    importing = tuple(file for file in _find_importers(root, folders[-1], _dotted(path)))
    name = path.parent.name if path.stem == "__init__" else path.stem
    for folder in folders:
        own = f"{folder}/test_{name}.py"
        if (root / own).is_file():
            return OwnTests((own,), True, _without((own,), nearest, *above, importing))
    return OwnTests(nearest, False, _without(nearest, *above, importing))


def _folders(module: PurePosixPath) -> list[PurePosixPath]:
    """The mirrored folder and those above it, down to that of the node."""
    parts = module.parent.parts
    inside = parts[1:] if parts[0] == "nodes" else parts
    return [PurePosixPath("tests", *inside[:end]) for end in range(len(inside), 0, -1)]


def _list_tests(root: Path, folder: PurePosixPath) -> tuple[str, ...]:
    """The files of a folder, with the one above it that is named like it."""
    named = root / folder.parent / f"test_{folder.name}.py"
    found = [*sorted((root / folder).glob("test_*.py")), *([named] if named.is_file() else [])]
    return tuple(path.relative_to(root).as_posix() for path in found)


def _without(first: tuple[str, ...], *wider: tuple[str, ...]) -> tuple[tuple[str, ...], ...]:
    """The groups that are not empty; a file of an earlier group is left out."""
    seen, kept = set(first), []
    for group in wider:
        if further := tuple(file for file in group if file not in seen):
            kept.append(further)
        seen.update(group)
    return tuple(kept)


def _dotted(module: PurePosixPath) -> str:
    """The name of a module, from `nodes`, as `import` has it."""
    parts = module.with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _find_importers(root: Path, folder: PurePosixPath, module: str) -> Iterator[str]:
    for path in sorted((root / folder).rglob("test_*.py")):
        if any(name == module or name.endswith(f".{module}") for name in _imported(path)):
            yield path.relative_to(root).as_posix()


@functools.cache
def _imported(path: Path) -> frozenset[str]:
    """The dotted names that a file imports, those in a module with their module's name before them."""
    names = set[str]()
    for node in ast.walk(ast.parse(path.read_text())):
        match node:
            case ast.Import():
                names.update(alias.name for alias in node.names)
            case ast.ImportFrom(module=str() as module):
                names.add(module)
                names.update(f"{module}.{alias.name}" for alias in node.names)
    return frozenset(names)
