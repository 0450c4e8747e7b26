"""A scene in JSON: `{"entities": [{"class": "Chair", "at": [1, 2, 0]}, ...]}`.

Its JSON Schema is `schemas/scene.schema.json`; `python -m nodes.coordinator.files.scene_file` prints it.
"""

from __future__ import annotations

import json

import msgspec
from msgspec import Struct

from nodes.coordinator.files.described import Described
from schemas import codec
from schemas.errors import BadFile, BadRequest


class SceneFile(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What stands in a scene."""

    entities: tuple[Described, ...]
    schema_: str = msgspec.field(name="$schema", default="")


def read(content: bytes, filename: str) -> tuple[Described, ...]:
    """The entities of a scene file. Raises BadFile naming the field at fault."""
    try:
        return codec.decode(content, SceneFile).entities
    except BadRequest as error:
        reason = error.text.removeprefix("malformed message: ")
        raise BadFile(f"{filename or 'the file'} is no scene: {reason}") from None


def json_schema() -> str:
    """The JSON Schema of scene files."""
    schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "semmap scene"}
    return json.dumps({**schema, **msgspec.json.schema(SceneFile)}, indent=2) + "\n"


if __name__ == "__main__":
    print(json_schema(), end="")
