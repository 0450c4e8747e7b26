"""Cloud files that Open3D reads: text formats, and variants that our readers do not support."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import BinaryIO

import numpy as np

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.files.columns import MAX_POINTS, Column, cloud_of
from semmap.nodes.perception_node.input.viewpoint import Placement
from semmap.schemas.errors import BadFile

SUFFIXES = (".xyz", ".xyzn", ".xyzrgb", ".pts")
_FIRST_LINE = 80


def read(path: Path, why: str = "", placement: Placement | None = None) -> Cloud:
    """Return the points of a file in a single row, with colours if Open3D reads any.

    `why`: the reason why our reader failed, for the message without Open3D. Raises BadFile without Open3D,
    ValueError for invalid files, and OSError.
    """
    if find_spec("open3d") is None:
        raise BadFile(
            f"{path}{f': {why}; this' if why else ''} requires Open3D, which is not installed (extra"
            " `perception`, Python up to 3.12); install it, or convert the file to a plain .pcd or .ply"
        )
    with path.open("rb") as file:  # without a file, Open3D only reports that there are no points
        if path.suffix.lower() == ".pts":
            _require_count(file)
    return _decoded(path, placement)


def _require_count(file: BinaryIO) -> None:
    """Raise ValueError unless a PTS file starts with its number of points, which Open3D does not check."""
    header = file.readline(_FIRST_LINE).strip()
    if not header.isdigit() or int(header) > MAX_POINTS:
        raise ValueError("its first line must be its number of points")
    lines = sum(1 for line in file if line.strip())
    if lines < int(header):
        raise ValueError(f"truncated: {lines} of {int(header)} points")


def _decoded(path: Path, placement: Placement | None) -> Cloud:
    import open3d

    with open3d.utility.VerbosityContextManager(open3d.utility.VerbosityLevel.Error):
        read = open3d.io.read_point_cloud(path, format=path.suffix.lower().removeprefix("."))
    points = np.asarray(read.points)
    if not len(points):
        raise ValueError("Open3D finds no points in it; each line must be numbers, x y z first")
    columns: dict[str, Column] = dict(zip("xyz", points.T, strict=True))
    if read.has_colors():
        shades = np.round(255.0 * np.asarray(read.colors))
        columns |= dict(zip(("red", "green", "blue"), shades.T, strict=True))
    return cloud_of(columns, 1, len(points), placement)
