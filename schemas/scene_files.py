"""Scenes in JSON: `{"entities": [{"class": "Chair", "at": [1, 2, 0]}, ...]}`.

Their JSON Schema is `schemas/scene.schema.json`; `python -m schemas.scene_files` prints it.
"""

from __future__ import annotations

import json
import re

import msgspec
from msgspec import Struct, field

from schemas import codec
from schemas.entities import (
    Angle,
    Name,
    Pose,
    Quaternion,
    Size,
    Text,
    Vector,
    orientation_from_yaw,
)
from schemas.errors import BadFile, BadRequest


class Described(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """One entity of a scene file.

    `at` is the bottom centre [m] in the map frame; `yaw` [rad] or `orientation` (unit quaternion wxyz) turns
    it; `size` is its extent along its own axes [m]; `ref` is what people call it, `alt` what they call it
    too.
    """

    class_: Text = field(name="class")
    name: Name | None = None
    at: Vector | None = None
    yaw: Angle | None = None
    orientation: Quaternion | None = None
    size: Size | None = None
    ref: Text | None = None
    alt: tuple[Text, ...] = ()
    affords: tuple[Text, ...] = ()
    """Affordances, by their names in the TBox: `containing`, `supporting`, ..."""


def pose_of(
    at: Vector, yaw: float | None, orientation: Quaternion | None, before: Pose | None = None
) -> Pose:
    """The pose that is asked for; without an angle the orientation stays as `before`. Raises BadRequest."""
    if yaw is not None and orientation is not None:
        raise BadRequest("give yaw or orientation, not both")
    if yaw is not None:
        return Pose(position_m=at, orientation_wxyz=orientation_from_yaw(yaw))
    try:
        if orientation is not None:
            return Pose(position_m=at, orientation_wxyz=orientation)
    except ValueError as error:
        raise BadRequest(str(error)) from None
    return (
        Pose(position_m=at)
        if before is None
        else Pose(position_m=at, orientation_wxyz=before.orientation_wxyz)
    )


_BOM = b"\xef\xbb\xbf"
_NO_JSON = re.compile(rb"[\[:,]\s*-?(?:NaN|Infinity)\b")


class SceneFile(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What stands in a scene."""

    entities: tuple[Described, ...]
    schema_: str = field(name="$schema", default="")


def read(content: bytes, filename: str) -> tuple[Described, ...]:
    """The entities of a scene file. Raises BadFile naming the field at fault."""
    try:
        return codec.decode(content.removeprefix(_BOM), SceneFile).entities
    except BadRequest as error:
        reason = error.text.removeprefix("malformed message: ")
        if _NO_JSON.search(content):
            reason += "; JSON has no NaN and no Infinity"
        raise BadFile(f"{filename or 'the file'} is no scene: {reason}") from None


def json_schema() -> str:
    """The JSON Schema of scene files."""
    schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "semmap scene"}
    return json.dumps({**schema, **msgspec.json.schema(SceneFile)}, indent=2) + "\n"


if __name__ == "__main__":
    print(json_schema(), end="")
