"""Meshes for viser: the surface of a model as a binary glTF file, in its own or in tinted colours."""

from __future__ import annotations

import json
import struct
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from semmap.schemas.scenes import Surface

Appearance = Literal["solid", "ghost", "believed", "past", "wall"]
"""The appearance of an object.

- `solid`: a normal body
- `ghost`: a non-colliding body
- `believed`: an entity without a body
- `past`: an entity in the past
- `wall`: a transparent wall
"""

_MAGIC, _VERSION, _JSON, _BINARY = 0x46546C67, 2, 0x4E4F534A, 0x004E4942
_FLOATS, _NUMBERS = 5126, 5125
_VERTICES, _INDICES = 34962, 34963

_TINTS: Final[dict[Appearance, tuple[tuple[float, float, float], float, float]]] = {
    "solid": ((0.0, 0.0, 0.0), 0.0, 1.0),
    "ghost": ((0.80, 0.84, 0.95), 0.45, 0.35),
    "believed": ((1.0, 0.80, 0.45), 0.55, 0.45),
    "past": ((0.96, 0.86, 0.66), 0.5, 1.0),
    "wall": ((0.95, 0.95, 0.96), 0.7, 0.2),
}
"""For each appearance a colour (linear RGB), its share, and the opacity."""


def opacity_of(appearance: Appearance) -> float:
    """Return the opacity of an appearance, 0 to 1."""
    return _TINTS[appearance][2]


def tinted(rgb: NDArray[np.floating[Any]], appearance: Appearance) -> NDArray[np.float32]:
    """Return linear colours (N, 3), 0 to 1, with the tint of an appearance."""
    tint, share, _ = _TINTS[appearance]
    return np.asarray(rgb * (1.0 - share) + np.array(tint) * share, dtype=np.float32)


def linear(srgb: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Convert 8-bit sRGB to linear RGB, 0 to 1, as glTF requires at vertices."""
    value = srgb.astype(np.float32) / 255.0
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4).astype(np.float32)


def srgb(rgb: NDArray[np.floating[Any]]) -> NDArray[np.uint8]:
    """Convert linear RGB, 0 to 1, to 8-bit sRGB."""
    value = np.clip(rgb, 0.0, 1.0)
    encoded = np.where(value <= 0.0031308, 12.92 * value, 1.055 * value ** (1.0 / 2.4) - 0.055)
    return np.asarray(np.round(255.0 * encoded), dtype=np.uint8)


def glb(surface: Surface, appearance: Appearance = "solid") -> bytes:
    """Return a surface of at least one triangle as a binary glTF 2.0 file with vertex colours."""
    points = np.frombuffer(surface.points, "<f4").reshape(-1, 3)
    normals = np.frombuffer(surface.normals, "<f4").reshape(-1, 3)
    colours = tinted(linear(np.frombuffer(surface.colours, np.uint8).reshape(-1, 3)), appearance)
    triangles = np.frombuffer(surface.triangles, "<u4")
    arrays = (points, normals, colours, triangles)
    binary = b"".join(array.tobytes() for array in arrays)  # each is a multiple of four bytes long
    ends = np.cumsum([0, *(array.nbytes for array in arrays)]).tolist()
    is_clear = opacity_of(appearance) < 1.0
    material = {
        "pbrMetallicRoughness": {
            "metallicFactor": 0.0,
            "roughnessFactor": 0.85,
            "baseColorFactor": [1.0, 1.0, 1.0, opacity_of(appearance)],
        },
        "alphaMode": "BLEND" if is_clear else "OPAQUE",
    }
    bounds = {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()}
    scene = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [
            {
                "primitives": [
                    {
                        "attributes": {"POSITION": 0, "NORMAL": 1, "COLOR_0": 2},
                        "indices": 3,
                        "material": 0,
                    }
                ]
            }
        ],
        "materials": [material],
        "accessors": [
            {"bufferView": 0, "componentType": _FLOATS, "count": len(points), "type": "VEC3", **bounds},
            {"bufferView": 1, "componentType": _FLOATS, "count": len(points), "type": "VEC3"},
            {"bufferView": 2, "componentType": _FLOATS, "count": len(points), "type": "VEC3"},
            {"bufferView": 3, "componentType": _NUMBERS, "count": len(triangles), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": start, "byteLength": array.nbytes, "target": target}
            for array, start, target in zip(arrays, ends, (_VERTICES,) * 3 + (_INDICES,), strict=False)
        ],
        "buffers": [{"byteLength": len(binary)}],
    }
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    length = 12 + 8 + len(text) + 8 + len(binary)
    return b"".join(
        (
            struct.pack("<III", _MAGIC, _VERSION, length),
            struct.pack("<II", len(text), _JSON),
            text,
            struct.pack("<II", len(binary), _BINARY),
            binary,
        )
    )


def cube() -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Return points (24, 3) and triangles (12, 3) of a unit cube with the origin at its bottom centre."""
    points: list[NDArray[np.float64]] = []
    triangles: list[tuple[int, int, int]] = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], dtype=float)
            face = np.insert(corners if side > 0 else corners[::-1], 0, side, axis=1)
            first = 4 * len(points)
            points.append(np.roll(face, axis, axis=1))
            triangles += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
    return (
        (np.concatenate(points) / 2.0 + (0.0, 0.0, 0.5)).astype(np.float32),
        np.array(triangles, dtype=np.uint32),
    )
