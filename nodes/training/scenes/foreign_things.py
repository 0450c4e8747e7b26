"""Third-party objects from a folder of data: upright meshes in metres."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from semmap.nodes.sim_node.models.model_files import keyed, read_model, stretched
from semmap.nodes.sim_node.models.parts import Colour, Part, Parts, Vec3
from semmap.nodes.training.scenes.paint import Pattern, printed_on

_LEARN = "train"


@dataclass(frozen=True)
class ForeignThing:
    """An object: its mesh, its acceptable classes, and whether it is of no known class (`new`).

    `learnable` means that models trained on it may be shipped.
    """

    name: str
    mesh: Path
    classes: tuple[str, ...]
    new: bool
    size_m: Vec3
    group: str
    learnable: bool


def foreign_things(folder: Path) -> list[ForeignThing]:
    """Return the objects in a folder's `things.json`, or none if there is no such file."""
    file = folder / "things.json"
    if not file.exists():
        return []
    return [
        ForeignThing(
            name=row["name"],
            mesh=folder / row["file"],
            classes=tuple(row["classes"]),
            new=row["new"],
            size_m=tuple(row["size_m"]),
            group=row["group"],
            learnable=_LEARN in row["use"],
        )
        for row in json.loads(file.read_text())
    ]


def parts_of(thing: ForeignThing, size_m: Vec3, colour: Colour) -> Parts:
    """Return the parts at a size, all in one colour."""
    parts = stretched([replace(part, colour=colour) for part in _read(thing.mesh)], size_m)
    return keyed(parts, f"{thing.mesh}:{size_m}")


@lru_cache
def _read(mesh: Path) -> Sequence[Part]:
    return read_model(mesh, None, 0).parts


@lru_cache(maxsize=64)
def texture_of(mesh: Path) -> Pattern | None:
    """Return the colours of a mesh's texture, or None if it has no texture."""
    import trimesh  # takes a second

    vertices, colours = [], []
    for part in trimesh.load_scene(mesh).dump():
        if getattr(part.visual, "uv", None) is None:
            return None
        vertices.append(np.asarray(part.vertices, np.float32))
        colours.append(np.asarray(part.visual.to_color().vertex_colors[:, :3], np.float32) / 255.0)
    if not vertices:
        return None
    points = np.concatenate(vertices)
    low, high = points.min(axis=0), points.max(axis=0)
    return printed_on(2.0 * (points - low) / (high - low) - 1.0, np.concatenate(colours))
