"""Rendering of a storyboard to an MP4 file."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from pathlib import Path
from typing import Final

import av
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from semmap.nodes.extern.movie.film import Film
from semmap.nodes.extern.movie.storyboard import Scene, interpolate, scenes, steps, total_s
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.kb_node.storage.replay.spans import span_of
from semmap.nodes.sim_node.vision.offscreen_scene import OffscreenScene
from semmap.nodes.sim_node.vision.view import View
from semmap.schemas import errors
from semmap.schemas.entities import Entity, Vector
from semmap.schemas.joints import select_joint_properties
from semmap.schemas.scenes import BodyOrder

Rgb = NDArray[np.uint8]
_LONGEST_S: Final = 3600.0
_QUALITY: Final = {"crf": "24", "preset": "faster", "tune": "animation"}
_PAPER, _INK = (24, 28, 33), (238, 240, 242)


def render_video(journal: Journal, file: Path, wanted: Film, tell: Callable[[str], None]) -> str:
    """Render a period of the history to `file`, and return a summary.

    `tell` receives progress messages. Raises Refused and BadRequest for an unknown period, camera or place,
    and for a video of more than an hour. Raises BadFile for a world or a file that cannot be used.
    """
    span = span_of(journal, wanted.since, wanted.until)
    past = HistoryReader(journal)
    start = {entity.name: entity for entity in past.entities(span.since)}
    commits = past.commits(range(span.since + 1, span.until + 1))
    is_compacted = span.since == journal.beginning.seq
    start_ns = journal.beginning.stamp_ns if is_compacted else journal.stamps.of(span.since)
    rhythm = {"speed": wanted.speed, "longest_s": wanted.longest_s}
    board = tuple(scenes(start, commits, since=span.since, start_ns=start_ns, **rhythm))
    if (seconds := total_s(board)) > _LONGEST_S:
        raise errors.BadRequest(
            f"the video would take {seconds / 3600:.1f} hours; the maximum is one hour; choose a shorter"
            " period, a higher --speed or a lower --longest"
        )
    box = None if wanted.place is None else _bounds_of(start, wanted.place)
    stage = OffscreenScene(wanted.world, models=wanted.models, data=wanted.data, graphics=wanted.graphics)
    with _open_container(file) as container:
        stream = container.add_stream("libx264", rate=Fraction(wanted.fps), options=_QUALITY)
        if not isinstance(stream, av.VideoStream):
            raise errors.InternalError("libx264 did not give a video stream")
        (stream.width, stream.height), stream.pix_fmt = wanted.even_size, "yuv420p"
        view: View | None = None
        for number, scene in enumerate(board, start=1):
            tell(f"rendering scene {number} of {len(board)}")
            _apply(stage, scene)
            view = view or stage.view(*wanted.picture_size, camera=wanted.camera, box=box)
            for rgb, frames in _render(stage, scene, view, wanted.fps):
                frame = av.VideoFrame.from_ndarray(add_caption(rgb, scene.caption, wanted.even_size), "rgb24")
                for _ in range(frames):
                    container.mux(stream.encode(frame))
                    frame.pts = None
        container.mux(stream.encode(None))
    how = "" if stage.has_graphics else "; by ray casting, because OpenGL is not available"
    size = file.stat().st_size / 1e6
    return f"wrote {file}: commits {span.since} to {span.until} in {seconds:.0f} s, {size:.1f} MB{how}"


def _open_container(file: Path) -> av.container.OutputContainer:
    try:
        return av.open(str(file), "w", format="mp4", options={"movflags": "faststart"})
    except (OSError, av.FFmpegError) as error:
        raise errors.BadFile(f"{file} cannot be written: {error.strerror}") from None


def _apply(stage: OffscreenScene, scene: Scene) -> None:
    """Add the new bodies of a scene, or those with a new shape or moved joints."""
    stage.add([_order(entity) for entity in scene.add])


def _render(stage: OffscreenScene, scene: Scene, view: View, fps: int) -> Iterator[tuple[Rgb, int]]:
    """Yield the images of a scene, each with its number of frames."""
    for share, frames in steps(scene, fps):
        if share == 1.0:
            stage.remove(scene.remove)
        stage.put({name: interpolate(was, now, share) for name, was, now in scene.glide})
        yield stage.picture(view, scene.labels), frames


def _order(entity: Entity) -> BodyOrder:
    if entity.pose is None:
        raise errors.InternalError(f"{entity.name} has no pose")
    return BodyOrder(
        name=entity.name,
        class_=entity.class_,
        model=entity.model,
        pose=entity.pose,
        size_m=entity.size_m,
        fixed=entity.fixed,
        properties=select_joint_properties(entity.properties),
        commit=entity.shape_provenance.commit,
    )


def _bounds_of(entities: Mapping[str, Entity], name: str) -> tuple[Vector, Vector]:
    """Return the lowest and highest corner of a place. Raises UnknownName, and Refused for other entities."""
    place = entities.get(name)
    if place is None:
        hint = errors.did_you_mean(name, [entity.name for entity in entities.values() if entity.place])
        raise errors.UnknownName(f"unknown place '{name}' at the start of the video{hint}")
    if not place.place or place.pose is None or place.size_m is None:
        raise errors.Refused(f"{name} is not a place with a position and a size")
    (x, y, z), (width, depth, height), yaw = place.pose.position_m, place.size_m, place.pose.yaw_rad
    across = (abs(width * math.cos(yaw)) + abs(depth * math.sin(yaw))) / 2
    along = (abs(width * math.sin(yaw)) + abs(depth * math.cos(yaw))) / 2
    return (x - across, y - along, z), (x + across, y + along, z + height)


def add_caption(rgb: Rgb, caption: str, size: tuple[int, int]) -> Rgb:
    """Return the image with a caption below it, in the size (width, height)."""
    width, height = size
    sheet = Image.new("RGB", size, _PAPER)
    sheet.paste(Image.fromarray(rgb), (0, 0))
    below = height - rgb.shape[0]
    font = ImageFont.load_default(max(9, round(below * 0.5)))
    draw = ImageDraw.Draw(sheet)
    while len(caption) > 4 and draw.textlength(caption, font) > width - below:
        caption = f"{caption[:-4]}..."
    draw.text((below // 2, height - below // 2), caption, _INK, font, anchor="lm")
    return np.asarray(sheet)
