"""The options of commands that load ontologies."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from semmap.ontology import HOUSEHOLD_TTL
from semmap.schemas import errors

HOUSEHOLD = "household"
"""The word for the TBox that comes with semmap; the file of that name is `./household`."""


def tbox_file(word: str) -> Path:
    """Return the file or folder of a TBox, or for `household` the shipped one."""
    return HOUSEHOLD_TTL if word == HOUSEHOLD else Path(word)


def require_there(tbox: Path) -> None:
    """Raises BadFile for a path where no file or folder is."""
    if not tbox.exists():
        is_word = not tbox.suffix and str(tbox) == tbox.name != HOUSEHOLD
        hint = f"; for the TBox of semmap use: {HOUSEHOLD}" if is_word else ""
        raise errors.BadFile(f"there is no file {tbox}{hint}")


class TBoxFile(click.Path):
    """A file or folder with a TBox, or the word `household`."""

    name = "path"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path that the word stands for."""
        return value if isinstance(value, Path) else tbox_file(str(super().convert(value, param, ctx)))


class _Import(click.ParamType[tuple[str, Path]]):
    name = "import"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, Path]:
        """Return `IRI=FILE` as a pair. The IRI may contain `=`: it ends before the first existing file."""
        if isinstance(value, tuple):
            iri, file = value
            return iri, file
        parts = value.split("=")
        for i in range(1, len(parts)):
            iri, file = "=".join(parts[:i]), Path("=".join(parts[i:]))
            if iri and file.is_file():
                return iri.strip("<>"), file.resolve()
        if len(parts) == 1 or not parts[0] or not parts[-1]:
            return self.fail(f"'{value}' is not IRI=FILE, as in http://example.org/things=things.owl")
        return self.fail(f"there is no file {value.partition('=')[2]}")


def spatial_root_option(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--spatial-root CLASS`, which may be repeated, as the parameter `spatial_root`."""
    return click.option(
        "--spatial-root",
        "spatial_root",
        multiple=True,
        metavar="CLASS",
        help="Class (IRI or name) whose instances have a position; may be repeated.",
    )(function)


def import_option(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--import IRI=FILE`, which may be repeated, as the pairs in the parameter `imports`."""
    return click.option(
        "--import",
        "imports",
        multiple=True,
        type=_Import(),
        metavar="IRI=FILE",
        help="File of an imported ontology, if no catalogue or neighbouring file has it; may be repeated.",
    )(function)
