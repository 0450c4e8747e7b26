"""Maps a module to its own tests."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path, PurePosixPath


@dataclass(frozen=True)
class OwnTests:
    """The files of tests that a change of a module is tried against."""

    files: tuple[str, ...]
    """From the root of the repository."""
    is_mirrored: bool
    """Whether there is a file for this module; else, they are those of its folder."""


def find_own_tests(root: Path, module: str) -> OwnTests:
    """Return the tests of `module`, a path from `root`.

    These are `tests/a/b/test_c.py` for `nodes/a/b/c.py`. If there is no such file, it is looked for in the
    folders above, up to `tests/a`. If there is none either, they are the files of the nearest folder that has
    any, with the one that is named like the folder: `tests/a/b/test_*.py` and `tests/a/test_b.py`.
    """
    path = PurePosixPath(module)
    folders = _folders(path)
    names = [path.parent.name] if path.stem == "__init__" else [path.stem]
    for folder in folders:
        for name in names:
            if (root / folder / f"test_{name}.py").is_file():
                return OwnTests((f"{folder}/test_{name}.py",), is_mirrored=True)
    for folder in folders:
        near = sorted((root / folder).glob("test_*.py")) if (root / folder).is_dir() else []
        named = root / folder.parent / f"test_{folder.name}.py"
        found = [*near, *([named] if named.is_file() else [])]
        if found:
            return OwnTests(tuple(p.relative_to(root).as_posix() for p in found), is_mirrored=False)
    return OwnTests((), is_mirrored=False)


def _folders(module: PurePosixPath) -> list[PurePosixPath]:
    """The mirrored folder and those above it, down to that of the node."""
    parts = module.parent.parts
    inside = parts[1:] if parts[0] == "nodes" else parts
    return [PurePosixPath("tests", *inside[:end]) for end in range(len(inside), 0, -1)]
