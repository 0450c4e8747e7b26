"""Reads frames from files of any supported format."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from semmap.nodes.perception_node.input.cloud import (
    FARTHEST_M,
    FEWEST_POINTS,
    NEAREST_M,
    Cloud,
    Transform,
)
from semmap.nodes.perception_node.input.files import (
    camera_files,
    depth_files,
    image_files,
    open3d_clouds,
    pcd,
    ply,
)
from semmap.nodes.perception_node.input.files.columns import OtherVariant
from semmap.nodes.perception_node.input.viewpoint import Placement, Up
from semmap.schemas.errors import BadFile, BadRequest
from semmap.schemas.wording import counted

_DECODERS: dict[str, Callable[[bytes, Placement | None], Cloud]] = {".pcd": pcd.decode, ".ply": ply.decode}
_PICTURES = (
    *(".png", ".tif", ".tiff", ".jpg", ".jpeg", ".bmp", ".webp", ".ppm", ".pgm"),
    *depth_files.ARRAYS,
    depth_files.OPENEXR,
)


def read_frames(
    files: Sequence[Path],
    camera: Path | None = None,
    up: Up | None = None,
    pose: Transform | None = None,
) -> Iterator[tuple[Path, Cloud]]:
    """Yield each frame in the order of the files, with the file of its points.

    A depth image is combined with the colour image before or after it; both need `camera`, a file of
    intrinsics. `pose`: (4, 4) of the camera, by default the one in `camera`. `up`: the axis that points up,
    if clouds are in the frame of a map or robot, and then the pose is in that frame. Raises BadFile and
    BadRequest.
    """
    if pose is None and camera is not None:
        pose = camera_files.pose_of(camera_files.load_camera(camera).map_from_camera)
    waiting: Path | None = None  # an image without its partner
    for path in files:
        if path.suffix.lower() not in _PICTURES:
            yield path, read_cloud(path, Placement(up, pose))
        elif waiting is None:
            waiting = path
        else:
            pair, waiting = (waiting, path), None
            yield _frame(pair, camera, pose)
    if waiting is not None:
        yield _frame((waiting,), camera, pose)


def read_cloud(path: Path, placement: Placement | None = None) -> Cloud:
    """Return the cloud in a file. Other variants of PCD and PLY are read by Open3D. Raises BadFile.

    `placement`: the frame of the points, if they are not in that of a camera.
    """
    suffix = path.suffix.lower()
    if suffix not in (*_DECODERS, *open3d_clouds.SUFFIXES):
        if path.is_dir():
            raise BadFile(f"{path} is a folder; for a dataset use: semmap perceive --frames {path}")
        supported = ", ".join((*_DECODERS, *open3d_clouds.SUFFIXES))
        raise BadFile(f"{path} is not a supported cloud; supported are {supported} and images")
    try:
        cloud = _decoded(path, suffix, placement)
    except OSError as error:
        raise BadFile(f"{path} cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise BadFile(f"{path} is not a valid cloud: {error}") from None
    return checked(cloud, path)


def _decoded(path: Path, suffix: str, placement: Placement | None) -> Cloud:
    if suffix not in _DECODERS:
        return open3d_clouds.read(path, placement=placement)
    try:
        return _DECODERS[suffix](path.read_bytes(), placement)
    except OtherVariant as error:
        return open3d_clouds.read(path, str(error), placement)


def checked(cloud: Cloud, path: Path) -> Cloud:
    """Return the cloud. Raises BadFile if it has too few points."""
    if cloud.points_camera.size == 0:
        raise BadFile(f"{path} contains no points")
    if cloud.measured < FEWEST_POINTS:
        raise BadFile(
            f"{path} has {counted(cloud.measured, 'point')} from {NEAREST_M:g} to {FARTHEST_M:g} m in front"
            f" of the camera; at least {FEWEST_POINTS} are needed"
        )
    return cloud


def _frame(files: Sequence[Path], camera_file: Path | None, pose: Transform | None) -> tuple[Path, Cloud]:
    """Return the frame of one depth image and at most one colour image."""
    if camera_file is None:
        raise BadRequest(f"{files[0]} is an image; add the camera's intrinsics with --intrinsics FILE")
    camera, of = camera_files.load_camera(camera_file), camera_file
    try:
        depths = []
        for of in files:
            depths.append(depth_files.is_depth(of))
        if sum(depths) != 1:
            count = "both are" if all(depths) else "none is" if len(files) > 1 else "it is not"
            raise BadFile(
                f"{' and '.join(map(str, files))}: {count} a 16-bit depth image; exactly one must be"
            )
        of = files[depths.index(True)]
        color = files[depths.index(False)] if len(files) > 1 else None
        cloud = image_files.read_pictures(of, color, camera)
        return of, replace(checked(cloud, of), map_from_camera=pose)
    except OSError as error:
        raise BadFile(f"{of} cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise BadFile(f"{of}: {error}") from None
