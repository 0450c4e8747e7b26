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
    from_pixel_centres,
    read_pinhole,
    scale_intrinsics,
)
from semmap.nodes.extern.frame_folders.poses import MAPS, TransformTree, plain, stamp_ns_of
from semmap.nodes.extern.frame_folders.topics import (
    COMPRESSED,
    IMAGE,
    INFO,
    TRANSFORMS,
    CameraTopicNames,
    choose,
)
from semmap.nodes.extern.ros.frames import Transform
from semmap.schemas.errors import BadFile, BadRequest, SemmapError
from semmap.schemas.wording import few

_ALIKE: Final = 0.02
"""Two cameras whose numbers differ by less, in widths of the picture, are one."""
_STILL_M: Final = 0.002
_STILL: Final = 0.01


@dataclass
class _Known:
    """What a recording says besides pixels: stamps and frames of the pictures, cameras, and transforms."""

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
    """The frames of a recording; some of its topics may be told, and in which frame poses are to be.

    Raises BadFile and BadRequest where there can be none.
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
            f"{path} has no pictures on {chosen.colour} and {chosen.depth} within {within_s:g} s of one"
            " another; --within takes more"
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
    """Of each topic with pictures how they are written, by the first. Raises BadFile without any."""
    found = {}
    for topic in _of_types(bag, IMAGE, COMPRESSED):
        first = next(iter(bag.messages([topic])), None)
        if first is not None:
            found[topic] = encoding_of(first[1])
    if not found:
        raise BadFile(f"it has no pictures; its topics: {few(sorted(bag.types))}")
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
    """The messages of each pair, when both have come; a colour picture waits for its depth or it for that."""
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
    """Makes frames of messages, with the intrinsics of the recording, or those of a file."""

    def __init__(self, chosen: CameraTopicNames, known: _Known, intrinsics: Path | None) -> None:
        """Raises BadFile where there are none, or where depth is not aligned to colour."""
        self._scale_m: float | None = None
        self._size: tuple[int, int] | None = None
        _require_aligned(chosen, known)
        if intrinsics is not None:
            told = read_pinhole(intrinsics)
            self._matrix, self._scale_m = (
                from_pixel_centres(told.fx, told.fy, told.cx, told.cy),
                told.depth_scale,
            )
            self._size = told.size
            self.whence = str(intrinsics)
            return
        topic = next((topic for topic in chosen.infos if topic in known.infos), None)
        if topic is None:
            raise BadFile(
                f"it has no camera_info of {chosen.depth} or {chosen.colour}; add --intrinsics FILE.json"
                " with fx, fy, cx, cy"
            )
        info = known.infos[topic]
        self._matrix = from_camera_info(info, rectified="rect" in chosen.depth or "rect" in chosen.colour)
        if not (self._matrix[0, 0] > 0 and self._matrix[1, 1] > 0):
            raise BadFile(f"{topic} has no focal length; add --intrinsics FILE.json with fx, fy, cx, cy")
        self._size, self.whence = (info.width, info.height), topic

    def frame(
        self, colour: Any, depth: Any
    ) -> tuple[NDArray[np.uint8], NDArray[np.float32], NDArray[np.float64]]:
        """Colour and depth of one size, that of the depth, and the intrinsics of that. Raises BadRequest."""
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
    """Raises BadFile where depth was taken from elsewhere, or with another lens, than colour."""
    frames = [plain(known.frames[topic]) for topic in (chosen.depth, chosen.colour)]
    apart = ""
    if all(frames) and frames[0] != frames[1]:
        moved = known.tree.between(frames[0], frames[1], known.stamps_ns[chosen.depth][0])
        if moved is None or not _is_identity(moved):
            apart = f"they are in the frames {frames[0]} and {frames[1]}"
    infos = [known.infos.get(topic) if topic else None for topic in chosen.infos]
    if not apart and chosen.infos[0] != chosen.infos[1] and all(info is not None for info in infos):
        lenses = [
            from_camera_info(info, rectified=False)[:2] / max(1, info.width)
            for info in infos
            if info is not None
        ]
        if not np.allclose(lenses[0], lenses[1], atol=_ALIKE):
            apart = f"{chosen.infos[0]} and {chosen.infos[1]} tell of two lenses"
    if apart:
        raise BadFile(
            f"its depth ({chosen.depth}) is not aligned to its colour ({chosen.colour}): {apart}; record the"
            " depth that the driver aligns to colour, or name its topic with --depth-topic"
        )


def _is_identity(pose: Transform) -> bool:
    return np.allclose(pose[:3, 3], 0.0, atol=_STILL_M) and np.allclose(pose[:3, :3], np.eye(3), atol=_STILL)


def _base(path: Path, known: _Known, chosen: CameraTopicNames, base: str | None) -> tuple[str | None, str]:
    """The frame in which poses are told, and what to say of it. Raises BadRequest where it is not there."""
    camera = plain(known.frames[chosen.depth])
    above = known.tree.above(camera)[1:]
    if base is not None:
        if plain(base) not in above:
            raise BadRequest(
                f"{path}: the camera's frame {camera!r} is not in {base!r} on /tf, but in {few(above)}"
            )
        return plain(base), f"camera poses in {base}"
    found = next((name for name in MAPS if name in above), None)
    if found is not None:
        return found, f"camera poses in {found}"
    if above:
        return None, f"no camera poses: on /tf the camera is in {few(above)}; --base names one whose z is up"
    return None, "no camera poses: there is nothing of the camera on /tf"
