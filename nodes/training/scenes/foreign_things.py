"""Things that nobody here modelled, from a folder of data: meshes, upright, in metres."""

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
    """A thing: its mesh, the classes that it may be said to be of, and whether it is of none (`new`).

    `learnable`: what is learnt from it may be shipped.
    """

    name: str
    mesh: Path
    classes: tuple[str, ...]
    new: bool
    size_m: Vec3
    group: str
    learnable: bool


def foreign_things(folder: Path) -> list[ForeignThing]:
    """The things that a folder's `things.json` tells of; none where there is no such file."""
    file = folder / "things.json"
    if not file.exists():
        return []
    return [
        ForeignThing(
            name=told["name"],
            mesh=folder / told["file"],
            classes=tuple(told["classes"]),
            new=told["new"],
            size_m=tuple(told["size_m"]),
            group=told["group"],
            learnable=_LEARN in told["use"],
        )
        for told in json.loads(file.read_text())
    ]


def parts_of(thing: ForeignThing, size_m: Vec3, colour: Colour) -> Parts:
    """Its parts at a size, all of one colour."""
    parts = stretched([replace(part, colour=colour) for part in _read(thing.mesh)], size_m)
    return keyed(parts, f"{thing.mesh}:{size_m}")


@lru_cache
def _read(mesh: Path) -> Sequence[Part]:
    return read_model(mesh, None, 0).parts


@lru_cache(maxsize=64)
def texture_of(mesh: Path) -> Pattern | None:
    """The colours that a thing has by its texture; None where it has none."""
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
