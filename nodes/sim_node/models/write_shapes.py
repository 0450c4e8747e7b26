"""Writes the shapes of the library's models for the knowledge base: `make shapes`.

The knowledge base does not load the library.
"""

from __future__ import annotations

import json
from collections.abc import Collection
from contextlib import suppress
from pathlib import Path

import msgspec
from msgspec import structs

from semmap.nodes.sim_node.models.library import ModelError, build
from semmap.nodes.sim_node.models.model_files import SUFFIXES, read_model
from semmap.nodes.sim_node.models.sources import Models, ReadModel, is_one_of
from semmap.nodes.sim_node.models.spaces import shape_of
from semmap.nodes.sim_node.models.variety_table import KINDS, VARIETIES
from semmap.ontology import MODEL_SHAPES_JSON
from semmap.ontology.model_shapes import ModelShape

_DIGITS = 4


def library_shapes() -> dict[str, ModelShape]:
    """Return the shape of each model at its own size, and for an alternative the model it replaces."""
    found = {name: shape_of(build(name, None)) for name in ("", *sorted(KINDS))}
    for name, (_, of, words, only_named) in VARIETIES.items():
        found[name] = structs.replace(found[name], of=of, words=words, only_named=only_named)
    return found


def own_shapes(folder: Path, read: ReadModel = read_model) -> dict[str, ModelShape]:
    """Return the shapes of the model files in a folder, by possible names in a TBox; `read` reads a file.

    An invalid file has none; the simulator reports the reason when it uses it.
    """
    models = Models(folder, read=read)
    found: dict[str, ModelShape] = {}
    for path in sorted(folder.iterdir()):
        if path.suffix not in SUFFIXES:
            continue
        try:
            shape = structs.replace(shape_of(models(path.name, None)), turns=False)
        except ModelError:
            continue
        found[path.name] = shape
        found.setdefault(path.stem, shape)
    return found


def own_notes(folder: Path, names: Collection[str], read: ReadModel = read_model) -> list[str]:
    """Return notes on the model files in a folder: what is omitted or does not move, one line per file.

    `names` are the classes' models; other files are ignored. `read` reads a file.
    """
    models = Models(folder, read=read)
    told: list[str] = []
    for path in sorted(folder.iterdir()):
        if is_one_of(path, names):
            with suppress(ModelError):
                if notes := models(path.name, None).notes:
                    told.append(f"{path.name}: {'; '.join(notes)}")
    return told


def write_own(folder: Path | None, target: Path, read: ReadModel = read_model) -> None:
    """Write the shapes of the models in a folder; without a folder there are none. `read` reads a file."""
    if folder is None:
        target.unlink(missing_ok=True)
    else:
        replace_file(target, own_shapes(folder, read))


def replace_file(target: Path, shapes: dict[str, ModelShape]) -> None:
    """Write shapes to a file completely or not at all, because nodes read it while they start."""
    beside = target.with_name(f"{target.name}.partly")
    beside.write_text(as_json(shapes))
    beside.replace(target)


def as_json(shapes: dict[str, ModelShape]) -> str:
    """Return the file's text: one line per model."""
    rows = (
        f"  {json.dumps(name)}: {json.dumps(_rounded(msgspec.to_builtins(shape)))}"
        for name, shape in shapes.items()
    )
    return "{\n" + ",\n".join(rows) + "\n}\n"


def _rounded(value: object) -> object:
    match value:
        case float():
            return round(value, _DIGITS) + 0.0
        case dict():
            return {key: _rounded(item) for key, item in value.items()}
        case list() | tuple():
            return [_rounded(item) for item in value]
    return value


if __name__ == "__main__":
    MODEL_SHAPES_JSON.write_text(as_json(library_shapes()))
