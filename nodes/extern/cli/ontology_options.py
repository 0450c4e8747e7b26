"""The option by which a person says in which file an imported ontology is."""

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
        """`IRI=FILE` as a pair. An IRI may have a `=`, too: what follows one and is a file counts."""
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
    """`--spatial-root CLASS`, which may be repeated: the function gets the words as `spatial_root`."""
    return click.option(
        "--spatial-root",
        "spatial_root",
        multiple=True,
        metavar="CLASS",
        help="A class (IRI or name) whose instances are things in space; may be repeated.",
    )(function)


def import_option(function: Callable[..., Any]) -> Callable[..., Any]:
    """`--import IRI=FILE`, which may be repeated: the function gets the pairs as `imports`."""
    return click.option(
        "--import",
        "imports",
        multiple=True,
        type=_Import(),
        metavar="IRI=FILE",
        help="Where an imported ontology is, unless a catalogue or a file beside says; may be repeated.",
    )(function)
