"""The verb `perceive`: finds objects in files; it needs no running system."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from rich.table import Table

from nodes.extern.cli.calling import print_json
from nodes.extern.cli.output.show import console
from nodes.extern.cli.output.tables import table
from nodes.extern.files import write_atomically
from nodes.runtime import extras
from schemas import errors, wording
from schemas.perception import Observation

if TYPE_CHECKING:
    from nodes.perception_node.views.segmented_view import Sight

_FRAMES = {"map": "map frame", "plane": "frame: the largest plane is z = 0, the camera above its origin"}


@click.command()
@click.argument("files", metavar="FILE...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "--labels",
    metavar="OUT.npy",
    type=click.Path(path_type=Path),
    help="Write the object label of each point to this .npy file.",
)
@click.option(
    "--intrinsics",
    metavar="FILE.json",
    type=click.Path(path_type=Path),
    help="JSON file with fx, fy, cx, cy [pixel] and, optionally, depth_scale [m] and map_from_camera.",
)
@click.option("--format", type=click.Choice(["table", "json"]), default="table", show_default=True)
def perceive(files: tuple[Path, ...], labels: Path | None, intrinsics: Path | None, format: str) -> None:
    """Find the objects in point clouds or in depth images.

    Clouds are PCD or PLY files; images are one in colour and one of depth (PNG). Labels are integers in the
    cloud's own shape, (height, width), or (1, points) when it is not organised: 0 for background, 1 to n
    for the objects.
    """
    if labels is not None and labels.suffix != ".npy":
        raise errors.BadRequest(
            f"labels are written as a NumPy array; name the file {labels.with_suffix('.npy').name}"
        )
    extras.require("semmap perceive", "perception")
    import numpy as np  # half of what the command line would take to start

    from nodes.perception_node.input.files.cloud_files import read_frames
    from nodes.perception_node.pipeline import one_by_one, shipped
    from nodes.perception_node.views.segmented_view import see

    frames = list(read_frames(files, intrinsics))
    if labels is not None and len(frames) != 1:
        raise errors.BadRequest(f"--labels takes one frame, and these are {len(frames)}")
    records = []
    for file, cloud in frames:
        sight = see(cloud)
        told = one_by_one(sight, shipped())
        frame = "plane" if cloud.map_from_camera is None else "map"
        if format == "json":
            records.append({"file": str(file), "frame": frame, "objects": _records(sight, told)})
        else:
            console().print(f"{file}: {wording.counted(len(told), 'object')}; {_FRAMES[frame]}")
            if told:
                console().print(_rows(sight, told))
        if labels is not None:
            buffer = io.BytesIO()
            np.save(buffer, np.where(np.isin(sight.labels, list(sight.carriers)), 0, sight.labels))
            write_atomically(labels, buffer.getvalue())
            if format == "table":
                print(f"wrote {labels}")
    if format == "json":
        print_json(records)


def _counts(sight: Sight) -> dict[int, int]:
    """How many points each label has."""
    return {segment.label: segment.count for segment in sight.segments}


def _records(sight: Sight, told: Mapping[int, Observation | None]) -> list[dict[str, Any]]:
    """Each object for programs: its label, its points, and the observation; null for clutter."""
    counts = _counts(sight)
    return [
        {"label": label, "points": counts[label], "observation": seen} for label, seen in sorted(told.items())
    ]


def _rows(sight: Sight, told: Mapping[int, Observation | None]) -> Table:
    """A row for each object: what it is taken for, and where the whole of it stands."""
    columns = ("object", "class", "probability", "points", "x", "y", "z", "yaw", "size [m]")
    rows = table(*columns, fold=("class", "size [m]"))
    counts = _counts(sight)
    for label, seen in sorted(told.items()):
        words = [str(label), "?", "", str(counts[label])]
        if seen is not None:
            words[1:3] = [seen.class_, f"{seen.probability:.2f}"]
            words += [f"{value:.3f}" for value in seen.pose.position_m]
            words += [f"{math.degrees(seen.pose.yaw_rad):.0f}°"]
            words += [" x ".join(f"{side:.3f}" for side in seen.size_m)]
        rows.add(*words, *[""] * (len(columns) - len(words)))
    return rows
