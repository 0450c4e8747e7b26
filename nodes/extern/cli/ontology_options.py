"""The options of commands that load ontologies."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click


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
