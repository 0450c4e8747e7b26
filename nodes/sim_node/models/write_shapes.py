"""The shapes of all models of the library, for the knowledge base, which does not have it: `make shapes`."""

from __future__ import annotations

import json
from collections.abc import Collection
from contextlib import suppress
from pathlib import Path

import msgspec
from msgspec import structs

from semmap.nodes.sim_node.models.library import ModelError, build
from semmap.nodes.sim_node.models.model_files import SUFFIXES
from semmap.nodes.sim_node.models.sources import Models, is_one_of
from semmap.nodes.sim_node.models.spaces import shape_of
from semmap.nodes.sim_node.models.variety_table import KINDS, VARIETIES
from semmap.ontology import MODEL_SHAPES_JSON
from semmap.ontology.model_shapes import ModelShape

_DIGITS = 4


def library_shapes() -> dict[str, ModelShape]:
    """Model name to shape at its own size, and where it is a variety what it is one of."""
    found = {name: shape_of(build(name, None)) for name in ("", *sorted(KINDS))}
    for name, (_, of, words, only_named) in VARIETIES.items():
        found[name] = structs.replace(found[name], of=of, words=words, only_named=only_named)
    return found


def own_shapes(folder: Path) -> dict[str, ModelShape]:
    """Those of the model files in a folder, by the names that a TBox may have for them.

    A file that cannot be used has none: the simulator says why when it meets it.
    """
    models = Models(folder)
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


def own_notes(folder: Path, names: Collection[str]) -> list[str]:
    """What of the model files in a folder is not in the models, or is stiff in them: a line for each file.

    `names` are those of the classes' models; files that are none of these are passed over.
    """
    models = Models(folder)
    told: list[str] = []
    for path in sorted(folder.iterdir()):
        if is_one_of(path, names):
            with suppress(ModelError):
                if notes := models(path.name, None).notes:
                    told.append(f"{path.name}: {'; '.join(notes)}")
    return told


def write_own(folder: Path | None, target: Path) -> None:
    """Write the shapes of the models in a folder; without a folder there are none."""
    if folder is None:
        target.unlink(missing_ok=True)
    else:
        target.write_text(as_json(own_shapes(folder)))


def as_json(shapes: dict[str, ModelShape]) -> str:
    """The file's text: a line for each model."""
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
