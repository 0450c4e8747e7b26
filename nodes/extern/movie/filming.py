"""Films a storyboard, and writes it to an MP4 file."""

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

from semmap.nodes.extern.movie.storyboard import Scene, between, scenes, steps, total_s
from semmap.nodes.extern.movie.wanted import Film
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.kb_node.storage.replay.spans import span_of
from semmap.nodes.sim_node.vision.film_set import FilmSet
from semmap.nodes.sim_node.vision.view import View
from semmap.schemas import errors
from semmap.schemas.entities import Entity, Vector
from semmap.schemas.scenes import BodyOrder

Rgb = NDArray[np.uint8]
_LONGEST_S: Final = 3600.0
_QUALITY: Final = {"crf": "24", "preset": "faster", "tune": "animation"}
_PAPER, _INK = (24, 28, 33), (238, 240, 242)


def film(journal: Journal, file: Path, wanted: Film, tell: Callable[[str], None]) -> str:
    """Film a span of the journal's history to `file`; what there is to say of the movie, in a sentence.

    `tell` is told how far it is. Raises Refused and BadRequest for a span, a camera or a place that is not
    there, and for a movie of more than an hour; BadFile for a world or a file that cannot be used.
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
            f"that would be a movie of {seconds / 3600:.1f} hours, and one hour is the longest; choose a"
            " shorter span, a higher --speed or a lower --longest"
        )
    box = None if wanted.place is None else _box_of(start, wanted.place)
    stage = FilmSet(wanted.world, models=wanted.models, data=wanted.data, graphics=wanted.graphics)
    with _opened(file) as container:
        stream = container.add_stream("libx264", rate=Fraction(wanted.fps), options=_QUALITY)
        if not isinstance(stream, av.VideoStream):
            raise errors.InternalError("libx264 did not give a video stream")
        (stream.width, stream.height), stream.pix_fmt = wanted.even_size, "yuv420p"
        view: View | None = None
        for number, scene in enumerate(board, start=1):
            tell(f"filming scene {number} of {len(board)}")
            _change(stage, scene)
            view = view or stage.view(*wanted.picture_size, camera=wanted.camera, box=box)
            for rgb, frames in _pictures(stage, scene, view, wanted.fps):
                frame = av.VideoFrame.from_ndarray(captioned(rgb, scene.caption, wanted.even_size), "rgb24")
                for _ in range(frames):
                    container.mux(stream.encode(frame))
                    frame.pts = None
        container.mux(stream.encode(None))
    how = "" if stage.has_graphics else "; ray-cast, because there is no OpenGL here"
    size = file.stat().st_size / 1e6
    return f"wrote {file}: commits {span.since} to {span.until} in {seconds:.0f} s, {size:.1f} MB{how}"


def _opened(file: Path) -> av.container.OutputContainer:
    try:
        return av.open(str(file), "w", format="mp4", options={"movflags": "faststart"})
    except (OSError, av.FFmpegError) as error:
        raise errors.BadFile(f"the movie cannot be written to {file}: {error.strerror}") from None


def _change(stage: FilmSet, scene: Scene) -> None:
    """Let come what comes; what has another shape is made anew."""
    stage.remove(entity.name for entity in scene.add)
    stage.add([_order(entity) for entity in scene.add])


def _pictures(stage: FilmSet, scene: Scene, view: View, fps: int) -> Iterator[tuple[Rgb, int]]:
    """The pictures of a scene, each with how many frames it stays."""
    for share, frames in steps(scene, fps):
        if share == 1.0:
            stage.remove(scene.remove)
        stage.put({name: between(was, now, share) for name, was, now in scene.glide})
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
        commit=entity.shape_provenance.commit,
    )


def _box_of(entities: Mapping[str, Entity], name: str) -> tuple[Vector, Vector]:
    """Lowest and highest corner of a place. Raises UnknownName; Refused for what is no place."""
    place = entities.get(name)
    if place is None:
        hint = errors.did_you_mean(name, [entity.name for entity in entities.values() if entity.place])
        raise errors.UnknownName(f"no place was named '{name}' when the movie begins{hint}")
    if not place.place or place.pose is None or place.size_m is None:
        raise errors.Refused(f"{name} is not a place with a position and a size")
    (x, y, z), (width, depth, height), yaw = place.pose.position_m, place.size_m, place.pose.yaw_rad
    across = (abs(width * math.cos(yaw)) + abs(depth * math.sin(yaw))) / 2
    along = (abs(width * math.sin(yaw)) + abs(depth * math.cos(yaw))) / 2
    return (x - across, y - along, z), (x + across, y + along, z + height)


def captioned(rgb: Rgb, caption: str, size: tuple[int, int]) -> Rgb:
    """The picture with a caption below it, as large (width, height) as it is to be."""
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
