"""The frames of a depth camera in a rosbag or an MCAP file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from semmap.nodes.extern.frame_folders.bag import Bag, open_bag
from semmap.nodes.extern.frame_folders.frames import RecordedFrame, Recording, require_plausible_unit
from semmap.nodes.extern.frame_folders.images import colour_of, depth_of, encoding_of
from semmap.nodes.extern.frame_folders.pairs import pairs
from semmap.nodes.extern.frame_folders.pinhole import (
    from_camera_info,
    scale_intrinsics,
)
from semmap.nodes.extern.frame_folders.poses import MAPS, TransformTree, stamp_ns_of, strip_slash
from semmap.nodes.extern.frame_folders.topics import (
    COMPRESSED,
    IMAGE,
    INFO,
    TRANSFORMS,
    CameraTopicNames,
    choose,
)
from semmap.nodes.extern.ros.frames import Transform
from semmap.nodes.perception_node.input.files.camera_files import load_camera
from semmap.schemas.errors import BadFile, BadRequest, SemmapError
from semmap.schemas.wording import few

_ALIKE: Final = 0.02
"""The maximum difference of the intrinsics of a camera, in widths of the image."""
_STILL_M: Final = 0.002
_STILL: Final = 0.01


@dataclass
class _Known:
    """The data of a recording without pixels: stamps and frames of images, cameras, and transforms."""

    stamps_ns: dict[str, list[int]] = field(default_factory=dict)
    frames: dict[str, str] = field(default_factory=dict)
    infos: dict[str, Any] = field(default_factory=dict)
    tree: TransformTree = field(default_factory=TransformTree)


def read(
    path: Path,
    *,
    within_s: float,
    every_s: float,
    intrinsics: Path | None,
    colour: str | None,
    depth: str | None,
    base: str | None,
) -> Recording:
    """Return the frames of a recording, from the given or detected topics, with poses in the frame `base`.

    Raises BadFile and BadRequest if there are no frames.
    """
    try:
        with open_bag(path) as bag:
            chosen = choose(_encodings(bag), _of_types(bag, INFO), colour, depth)
            known = _known(bag, chosen)
        camera = _Camera(chosen, known, intrinsics)
    except BadFile as error:
        raise BadFile(error.text if str(path) in error.text else f"{path}: {error.text}") from None
    except BadRequest as error:
        raise BadRequest(f"{path}: {error.text}") from None
    colours_ns, depths_ns = known.stamps_ns[chosen.colour], known.stamps_ns[chosen.depth]
    found = pairs(colours_ns, depths_ns, within_s, every_s)
    if not found.taken:
        raise BadFile(
            f"{path}: no images on {chosen.colour} and {chosen.depth} are within {within_s:g} s of each"
            " other; use a larger --within"
        )
    where, note = _base(path, known, chosen, base)
    notes = [f"colour of {chosen.colour}, depth of {chosen.depth}, camera of {camera.whence}", *found.notes]

    def frames() -> Iterator[RecordedFrame | SemmapError]:
        with open_bag(path) as bag:
            for stamp_ns, pictures in _taken(bag, chosen, found.taken, depths_ns):
                try:
                    rgb, depth_m, matrix = camera.frame(*pictures)
                    pose = None
                    if where is not None:
                        pose = known.tree.pose(known.frames[chosen.depth], where, stamp_ns)
                    yield RecordedFrame(stamp_ns, rgb, depth_m, matrix, pose)
                except SemmapError as error:
                    yield error

    return Recording(len(found.taken), frames(), [*notes, note])


def _of_types(bag: Bag, *types: str) -> list[str]:
    return [topic for topic, said in bag.types.items() if said in types]


def _encodings(bag: Bag) -> dict[str, str]:
    """Return the image encodings by topic, from the first message. Raises BadFile without images."""
    found = {}
    for topic in _of_types(bag, IMAGE, COMPRESSED):
        first = next(iter(bag.messages([topic])), None)
        if first is not None:
            found[topic] = encoding_of(first[1])
    if not found:
        raise BadFile(f"no images found; topics: {few(sorted(bag.types))}")
    return found


def _known(bag: Bag, chosen: CameraTopicNames) -> _Known:
    found = _Known(stamps_ns={chosen.colour: [], chosen.depth: []})
    infos = [topic for topic in chosen.infos if topic is not None]
    transforms = _of_types(bag, *TRANSFORMS)
    for topic, message in bag.messages({chosen.colour, chosen.depth, *infos, *transforms}):
        if topic in transforms:
            found.tree.take(message, static=topic.endswith("_static"))
        elif topic in infos:
            found.infos.setdefault(topic, message)
        else:
            found.stamps_ns[topic].append(stamp_ns_of(message.header.stamp))
            found.frames.setdefault(topic, message.header.frame_id)
    return found


def _taken(
    bag: Bag, chosen: CameraTopicNames, taken: list[tuple[int, int]], depths_ns: list[int]
) -> Iterator[tuple[int, tuple[Any, Any]]]:
    """Yield the messages of each pair of a colour and a depth image when both are read."""
    pair_of = {(chosen.colour, one): n for n, (one, _) in enumerate(taken)}
    pair_of |= {(chosen.depth, other): n for n, (_, other) in enumerate(taken)}
    seen = {chosen.colour: 0, chosen.depth: 0}
    waiting: dict[int, tuple[str, Any]] = {}
    for topic, message in bag.messages({chosen.colour, chosen.depth}):
        pair = pair_of.get((topic, seen[topic]))
        seen[topic] += 1
        if pair is None:
            continue
        if pair not in waiting:
            waiting[pair] = topic, message
            continue
        _, other = waiting.pop(pair)
        yield depths_ns[taken[pair][1]], (message, other) if topic == chosen.colour else (other, message)


class _Camera:
    """Converts messages to frames, with the intrinsics of the recording or of a file."""

    def __init__(self, chosen: CameraTopicNames, known: _Known, intrinsics: Path | None) -> None:
        """Raise BadFile if there are no intrinsics, or if depth is not aligned to colour."""
        self._scale_m: float | None = None
        self._size: tuple[int, int] | None = None
        _require_aligned(chosen, known)
        if intrinsics is not None:
            camera = load_camera(intrinsics)
            self._matrix = camera.intrinsics
            self._scale_m = camera.depth_scale
            self._size = camera.size
            self.whence = str(intrinsics)
            return
        topic = next((topic for topic in chosen.infos if topic in known.infos), None)
        if topic is None:
            raise BadFile(
                f"no camera_info for {chosen.depth} or {chosen.colour}; add --intrinsics FILE.json with fx,"
                " fy, cx, cy"
            )
        info = known.infos[topic]
        self._matrix = from_camera_info(info, rectified="rect" in chosen.depth or "rect" in chosen.colour)
        if not (self._matrix[0, 0] > 0 and self._matrix[1, 1] > 0):
            raise BadFile(f"{topic} has no focal length; add --intrinsics FILE.json with fx, fy, cx, cy")
        self._size, self.whence = (info.width, info.height), topic

    def frame(
        self, colour: Any, depth: Any
    ) -> tuple[NDArray[np.uint8], NDArray[np.float32], NDArray[np.float64]]:
        """Return colour and depth in the size of the depth image, and its intrinsics. Raises BadRequest."""
        rgb, depth_m = colour_of(colour), depth_of(depth, self._scale_m)
        if self._scale_m is None:
            require_plausible_unit(depth_m, 1.0 if "32FC1" in encoding_of(depth) else 0.001)
        height, width = depth_m.shape
        try:
            matrix = scale_intrinsics(self._matrix, self._size or (width, height), (width, height))
            if rgb.shape[:2] != depth_m.shape:
                scale_intrinsics(matrix, (width, height), (rgb.shape[1], rgb.shape[0]))  # of the same shape
                rgb = np.asarray(Image.fromarray(rgb).resize((width, height), Image.Resampling.BOX))
        except ValueError as error:
            raise BadRequest(f"{self.whence}: {error}") from None
        return rgb, depth_m, matrix


def _require_aligned(chosen: CameraTopicNames, known: _Known) -> None:
    """Raise BadFile if depth and colour were taken from different positions or with different lenses."""
    frames = [strip_slash(known.frames[topic]) for topic in (chosen.depth, chosen.colour)]
    apart = ""
    if all(frames) and frames[0] != frames[1]:
        moved = known.tree.between(frames[0], frames[1], known.stamps_ns[chosen.depth][0])
        if moved is None or not _is_identity(moved):
            apart = f"their frames are {frames[0]} and {frames[1]}"
    infos = [known.infos.get(topic) if topic else None for topic in chosen.infos]
    if not apart and chosen.infos[0] != chosen.infos[1] and all(info is not None for info in infos):
        lenses = [
            from_camera_info(info, rectified=False)[:2] / max(1, info.width)
            for info in infos
            if info is not None
        ]
        if not np.allclose(lenses[0], lenses[1], atol=_ALIKE):
            apart = f"{chosen.infos[0]} and {chosen.infos[1]} have different intrinsics"
    if apart:
        raise BadFile(
            f"depth ({chosen.depth}) is not aligned to colour ({chosen.colour}): {apart}; record the depth"
            " topic that the driver aligns to colour, or name it with --depth-topic"
        )


def _is_identity(pose: Transform) -> bool:
    return np.allclose(pose[:3, 3], 0.0, atol=_STILL_M) and np.allclose(pose[:3, :3], np.eye(3), atol=_STILL)


def _base(path: Path, known: _Known, chosen: CameraTopicNames, base: str | None) -> tuple[str | None, str]:
    """Return the frame of the camera poses, and a note. Raises BadRequest for an unknown frame."""
    camera = strip_slash(known.frames[chosen.depth])
    above = known.tree.above(camera)[1:]
    if base is not None:
        if strip_slash(base) not in above:
            raise BadRequest(
                f"{path}: frame {base!r} is not an ancestor of the camera frame {camera!r} on /tf; ancestors:"
                f" {few(above)}"
            )
        return strip_slash(base), f"camera poses in {base}"
    found = next((name for name in MAPS if name in above), None)
    if found is not None:
        return found, f"camera poses in {found}"
    if above:
        return None, f"no camera poses; ancestors on /tf: {few(above)}; choose one with z up by --base"
    return None, "no camera poses: the camera frame is not on /tf"
