"""The shapes of all models of the library, for the knowledge base, which does not have it: `make shapes`."""

from __future__ import annotations

import json

import msgspec

from nodes.sim_node.models.library import build
from nodes.sim_node.models.model_table import MODELS
from nodes.sim_node.models.spaces import shape_of
from ontology import MODEL_SHAPES_JSON
from ontology.model_shapes import ModelShape

_DIGITS = 4


def library_shapes() -> dict[str, ModelShape]:
    """Model name to shape at its own size."""
    return {name: shape_of(build(name, None)) for name in ("", *sorted(MODELS))}


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
