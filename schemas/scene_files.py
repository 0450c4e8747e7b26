"""Scenes in JSON: `{"entities": [{"class": "Chair", "at": [1, 2, 0]}, ...]}`; worlds can have `"cameras"`.

Their JSON Schema is `schemas/scene.schema.json`; `python -m semmap.schemas.scene_files` prints it.
"""

from __future__ import annotations

import json
import math
import re
from typing import Annotated

import msgspec
from msgspec import Meta, Struct, field

from semmap.schemas import codec
from semmap.schemas.entities import (
    NAME_PATTERN,
    Angle,
    Name,
    Pose,
    Quaternion,
    Size,
    Text,
    Vector,
    composed,
    orientation_from_yaw,
    parse_angle,
    require_unit,
)
from semmap.schemas.errors import BadFile, BadRequest


class Described(Struct, frozen=True, gc=False, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """One entity of a scene file.

    `at` is the bottom centre [m] in the map frame, and `yaw` (radians, or "90deg") or `orientation` (unit
    quaternion wxyz) its orientation. `size` is the extent along its own axes [m]. `ref` is its label, `alt`
    are aliases. `extent` is the area of a place in WKT: `POLYGON ((x y, ...))`. `set` are other properties,
    each written `PROPERTY=VALUE`; an individual in a value must precede it in the file or be in the map.

    Instead of `at`, an object of a map is placed `on`, `in` or `next_to` an entity that precedes it in the
    file or is in the map, where there is room. If it is there already, it stays where it is.
    """

    class_: Text = field(name="class")
    name: Name | None = None
    at: Vector | None = None
    yaw: Angle | None = None
    orientation: Quaternion | None = None
    size: Size | None = None
    extent: Annotated[str, Meta(min_length=1, max_length=50_000)] | None = None
    ref: Text | None = None
    alt: tuple[Text, ...] = ()
    on: Text | None = None
    in_: Text | None = field(name="in", default=None)
    next_to: Text | None = None
    affords: tuple[Text, ...] = ()
    """Affordances by their names in the TBox: `containing`, `supporting`, ..."""
    set: tuple[Text, ...] = ()

    def __post_init__(self) -> None:
        if self.name is not None and not self.name.isascii():
            msgspec.structs.force_setattr(self, "name", composed(self.name))
        if self.yaw is not None:
            msgspec.structs.force_setattr(self, "yaw", parse_angle(self.yaw))
        if self.orientation is not None:
            if self.yaw is not None:
                raise ValueError("give yaw or orientation, not both")
            require_unit(self.orientation)


_NARROWEST_RAD, _WIDEST_RAD = 0.02, 3.0
_NOWHERE_M = 1e-6
FieldOfView = Annotated[float, Meta(extra_json_schema={"minimum": _NARROWEST_RAD, "maximum": _WIDEST_RAD})]


class Camera(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """A camera of a world, at `at` [m] in the map frame.

    It points at `look_at` [m], with the map's z axis up in the image, or it has an `orientation` (unit
    quaternion wxyz) of its optical frame: x to the right, y down, z into the scene. `fovy` is its vertical
    field of view [rad].
    """

    at: Vector
    name: Name | None = None
    look_at: Vector | None = None
    orientation: Quaternion | None = None
    fovy: FieldOfView = 1.0

    def __post_init__(self) -> None:
        if (self.look_at is None) == (self.orientation is None):
            raise ValueError("a camera needs either look_at or orientation")
        if self.look_at is not None and math.dist(self.at, self.look_at) < _NOWHERE_M:
            raise ValueError("look_at is the camera's own position")
        if self.orientation is not None:
            require_unit(self.orientation)
        if not _NARROWEST_RAD <= self.fovy <= _WIDEST_RAD:
            raise ValueError(
                f"fovy is {self.fovy:g}; it must be from {_NARROWEST_RAD:g} to {_WIDEST_RAD:g} radians"
            )


def pose_of(
    at: Vector, yaw: float | None, orientation: Quaternion | None, before: Pose | None = None
) -> Pose:
    """Return the requested pose; without an angle, the orientation is that of `before`. Raises BadRequest."""
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
_NAME_IN_JSON_SCHEMA = r"^[\p{L}_][\p{L}\p{M}\p{N}_.-]{0,127}$"
"""NAME_PATTERN as a JavaScript regular expression, which editors use."""
_NO_JSON = re.compile(rb"[\[:,]\s*-?(?:NaN|Infinity)\b")


class SceneFile(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The content of a scene file. `cameras` are used only in a world; null means its default cameras."""

    entities: tuple[Described, ...]
    cameras: tuple[Camera, ...] | None = None
    schema_: str = field(name="$schema", default="")

    def __post_init__(self) -> None:
        names = [camera.name for camera in self.cameras or () if camera.name is not None]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"two cameras are named {name}")


def read(content: bytes, filename: str) -> SceneFile:
    """Parse a scene file. Raises BadFile with the invalid field."""
    try:
        return codec.decode(content.removeprefix(_BOM), SceneFile)
    except BadRequest as error:
        reason = error.text.removeprefix("malformed message: ")
        if _NO_JSON.search(content):
            reason += "; JSON does not allow NaN and Infinity"
        raise BadFile(f"{filename or 'the file'} is not a valid scene: {reason}") from None


def json_schema() -> str:
    """Return the JSON Schema of scene files."""
    schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "semmap scene"}
    text = json.dumps({**schema, **msgspec.json.schema(SceneFile)}, indent=2)
    return text.replace(json.dumps(NAME_PATTERN), json.dumps(_NAME_IN_JSON_SCHEMA)) + "\n"


if __name__ == "__main__":
    print(json_schema(), end="")
