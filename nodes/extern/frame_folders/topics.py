"""Selection of the camera topics of a recording."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Final, NamedTuple

from semmap.nodes.extern.frame_folders.images import is_colour, is_depth
from semmap.schemas.errors import BadFile, BadRequest
from semmap.schemas.wording import few

IMAGE: Final = "sensor_msgs/msg/Image"
COMPRESSED: Final = "sensor_msgs/msg/CompressedImage"
INFO: Final = "sensor_msgs/msg/CameraInfo"
TRANSFORMS: Final = "tf2_msgs/msg/TFMessage", "tf/msg/tfMessage"
_ALIGNED = re.compile(r"aligned|registered|hw_registered")
_INFRARED = re.compile(r"(^|[/_])(ir|infra\d?|infrared)([/_]|$)")
_TRANSPORT = re.compile(r"/(compressed|compressedDepth)$")


class CameraTopicNames(NamedTuple):
    """The topics of a camera; `infos` are the camera_info topics of depth and colour, if there are any."""

    colour: str
    depth: str
    infos: tuple[str | None, str | None]


def choose(
    encodings: Mapping[str, str], infos: Iterable[str], colour: str | None, depth: str | None
) -> CameraTopicNames:
    """Choose the topics of a camera from the image encodings by topic and the camera_info topics.

    `colour` and `depth` are set by the user, or None. Raises BadFile if there is no such topic, and
    BadRequest if there are several.
    """
    for option, encoding in (("--rgb-topic", colour), ("--depth-topic", depth)):
        if encoding is not None and encoding not in encodings:
            raise BadRequest(f"{option}: no images on {encoding}; image topics: {few(sorted(encodings))}")
    seen = {topic: encoding for topic, encoding in encodings.items() if not _INFRARED.search(topic)}
    depths = [topic for topic, encoding in seen.items() if is_depth(encoding)]
    colours = [topic for topic, encoding in seen.items() if is_colour(encoding) and topic not in depths]
    colours = [topic for topic in colours if "mono8" not in seen[topic]] or colours
    aligned = [topic for topic in depths if _ALIGNED.search(topic)]
    depth = depth or _only("depth", "--depth-topic", aligned or depths, encodings)
    colour = colour or _only("colour", "--rgb-topic", colours, encodings)
    known = list(infos)
    return CameraTopicNames(colour, depth, (_nearest(depth, known), _nearest(colour, known)))


def _only(kind: str, option: str, topics: Sequence[str], encodings: Mapping[str, str]) -> str:
    """Return the only topic; of raw and compressed topics with the same images, the raw one."""
    plain = [topic for topic in topics if _TRANSPORT.sub("", topic) == topic]
    rest = [topic for topic in topics if _TRANSPORT.sub("", topic) not in plain]
    found = sorted({*plain, *rest})
    if not found:
        there = few([f"{topic} ({encoding})" for topic, encoding in sorted(encodings.items())])
        raise BadFile(f"no {kind} images found; image topics: {there}")
    if len(found) > 1:
        raise BadRequest(f"{kind} images on several topics: {few(found)}; choose one with {option}")
    return found[0]


def _nearest(topic: str, infos: Sequence[str]) -> str | None:
    """Return the camera_info topic with the longest common path, unless there are several."""
    parts = topic.split("/")

    def shared(info: str) -> int:
        count = 0
        for one, other in zip(parts, info.split("/"), strict=False):
            if one != other:
                break
            count += 1
        return count

    if not infos:
        return None
    best = max(map(shared, infos))
    nearest = [info for info in infos if shared(info) == best]
    return nearest[0] if len(nearest) == 1 else None
