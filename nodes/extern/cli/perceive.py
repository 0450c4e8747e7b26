"""The verb that looks at frames in files; it needs no system."""

from __future__ import annotations

import io
from pathlib import Path

import click
import numpy as np

from nodes.extern.cli.show import console
from nodes.extern.cli.tables import table
from nodes.extern.cli.talking import write_atomically
from schemas import errors


@click.command()
@click.argument("files", metavar="FILE...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "--labels", metavar="OUT.npy", type=click.Path(path_type=Path), help="Write each point's object."
)
@click.option(
    "--intrinsics",
    metavar="FILE.json",
    type=click.Path(path_type=Path),
    help="Of the camera that took pictures: fx, fy, cx, cy [pixel]; depth_scale [m], map_from_camera.",
)
def perceive(files: tuple[Path, ...], labels: Path | None, intrinsics: Path | None) -> None:
    """Find the objects in FILE...: PCD or PLY clouds, or a colour and a depth picture (PNG).

    Labels are integers in the cloud's own shape, (height, width), or (1, points) when it is not organised:
    0 for background, 1 to n for the objects.
    """
    from nodes.perception_node.files.reading import read_frames
    from nodes.perception_node.segmentation import segment

    frames = list(read_frames(files, intrinsics))
    if labels is not None and len(frames) != 1:
        raise errors.BadRequest(f"--labels takes one frame, and these are {len(frames)}")
    if labels is not None and labels.suffix != ".npy":
        raise errors.BadRequest(f"labels are a NumPy array; call the file {labels.with_suffix('.npy').name}")
    for file, cloud in frames:
        found = segment(cloud)
        rows = table("object", "points", "x", "y", "z", "size [m]")
        for number in range(1, int(found.labels.max(initial=0)) + 1):
            points = cloud.points_camera[found.labels == number]
            x, y, z = np.median(points, axis=0)
            size = " x ".join(f"{side:.2f}" for side in np.ptp(points, axis=0))
            rows.add_row(str(number), str(len(points)), f"{x:.3f}", f"{y:.3f}", f"{z:.3f}", size)
        planes = ", ".join(f"{plane.kind} ({plane.points} cells)" for plane in found.planes) or "none"
        console().print(f"{file}: {rows.row_count} objects; planes: {planes}")
        if rows.row_count:
            console().print(rows)
        if labels is not None:
            buffer = io.BytesIO()
            np.save(buffer, found.labels)
            write_atomically(labels, buffer.getvalue())
            print(f"wrote {labels}")
