"""Cloud files that Open3D reads for us: points in words, and what our own readers do not know."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import BinaryIO

import numpy as np

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.files.columns import MAX_POINTS, Column, cloud_of
from semmap.schemas.errors import BadFile

SUFFIXES = (".xyz", ".xyzn", ".xyzrgb", ".pts")
_FIRST_LINE = 80


def read(path: Path, why: str = "") -> Cloud:
    """The points of a file in a single row, and their colours where Open3D reads any.

    `why`: what kept our own reader from it, for the message when Open3D is not there. Raises BadFile without
    Open3D, ValueError for what it cannot read, OSError.
    """
    if find_spec("open3d") is None:
        raise BadFile(
            f"{path}{f': {why}; this' if why else ''} is read with Open3D, which is not installed (semmap's"
            " extra `perception` brings it for Python up to 3.12); or write it as a plain .pcd or .ply"
        )
    with path.open("rb") as file:  # of what is no file Open3D would only say that it has no points
        if path.suffix.lower() == ".pts":
            _require_count(file)
    return _decoded(path)


def _require_count(file: BinaryIO) -> None:
    """Raise ValueError unless a PTS file begins with how many points it has: Open3D trusts it blindly."""
    said = file.readline(_FIRST_LINE).strip()
    if not said.isdigit() or int(said) > MAX_POINTS:
        raise ValueError("its first line is not the number of its points")
    lines = sum(1 for line in file if line.strip())
    if lines < int(said):
        raise ValueError(f"truncated: {lines} of {int(said)} points")


def _decoded(path: Path) -> Cloud:
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
    return cloud_of(columns, 1, len(points))
