"""Which thing of a picture is the one that is shown, and what it looks like."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.files.frame_folders import frames_in, read_frame
from semmap.nodes.perception_node.pipeline import parts_in
from semmap.nodes.perception_node.recognition.features import features_of
from semmap.nodes.perception_node.recognition.likeness import views_of
from semmap.nodes.perception_node.recognition.pieces import put_together
from semmap.nodes.perception_node.recognition.shipped_votes import Learnt
from semmap.nodes.perception_node.recognition.sides import completed, side_features
from semmap.nodes.perception_node.recognition.standing_alone import is_compact
from semmap.nodes.perception_node.recognition.vote import expected_sizes, leaves
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.nodes.perception_node.views.merged_thing import Thing, thing_of
from semmap.nodes.perception_node.views.segmented_view import see
from semmap.schemas import errors
from semmap.schemas.entities import Size
from semmap.schemas.wording import counted

BoxPx = tuple[int, int, int, int]
"""First column and row, and those after the last [pixel]."""

_INSIDE = 0.7
"""What has so much of its pixels in a box is meant by it."""


@dataclass(frozen=True)
class View:
    """What a thing looks like: `features` (WIDTH,), and its size as far as one view tells it [m]."""

    features: Numbers
    size_m: Size


def view_of(thing: Thing, learnt: Learnt) -> View:
    """What recognition remembers of a thing."""
    features = features_of([thing])
    expected = expected_sizes(leaves(learnt, features), learnt.sizes_m)[0]
    x, y, z = completed(thing, side_features(thing, expected), learnt.sides).size_m.tolist()
    return View(views_of(features)[0], (max(x, y), min(x, y), z))


def shown_in_frames(folder: Path, learnt: Learnt, box_px: BoxPx | None) -> tuple[list[View], tuple[str, ...]]:
    """The thing in each frame of a dataset, and what is to be said of frames that show none.

    Raises BadFile where no frame shows one, with the
    reason of the first; BadRequest for a bad box.
    """
    views, wrong = list[View](), list[errors.BadFile]()
    for frame_folder in frames_in(folder):
        try:
            frame = read_frame(frame_folder)
            box = None if box_px is None else _thinned(box_px, frame.shape, frame.step)
            thing = shown_in(frame.cloud, learnt, box)
            if thing is None:
                what = "no compact thing that stands by itself" if box is None else "nothing in that box"
                raise errors.BadFile(f"{frame_folder.name} shows {what}; {_HINT[box is None]}")
        except errors.BadFile as error:
            wrong.append(error)
            continue
        views.append(view_of(thing, learnt))
    if not views:
        raise wrong[0]
    if not wrong:
        return views, ()
    return views, (f"{counted(len(wrong), 'frame')} could not be used, the first: {wrong[0].text}",)


_HINT = {
    True: "put it on a table, alone, or say where it is with --box",
    False: "a box is X0 Y0 X1 Y1 in the colour picture [pixel] around the whole thing",
}


def shown_in(cloud: Cloud, learnt: Learnt, box_px: BoxPx | None = None) -> Thing | None:
    """The largest compact thing that a cloud shows, or all that lies in a box; None where there is none."""
    parts = parts_in([see(cloud)])
    if box_px is not None:
        inside = [
            n
            for n, share in enumerate(_shares(parts.labels[0], box_px))
            if share >= _INSIDE and not parts.things[n].carrier
        ]
        segments = [segment for n in inside for segment in parts.things[n].segments]
        return thing_of(segments, parts.supports) if segments else None
    things, _, _ = put_together(parts.things, parts.held_for_one, learnt, parts.join)
    return max((thing for thing in things if is_compact(thing)), key=lambda thing: thing.count, default=None)


def _shares(labels: NDArray[np.int32], box_px: BoxPx) -> Sequence[float]:
    """How much of each part, from the first, is in a box: `labels` (H, W), counted from 1."""
    left, top, right, bottom = box_px
    count = int(labels.max(initial=0)) + 1
    total = np.bincount(labels.ravel(), minlength=count)
    within = np.bincount(labels[top:bottom, left:right].ravel(), minlength=count)
    return (within / np.maximum(total, 1))[1:].tolist()  # type: ignore[no-any-return]


def _thinned(box_px: BoxPx, shape: tuple[int, int], step: int) -> BoxPx:
    """A box in every `step`-th row and column of a picture. Raises BadRequest for one that is not in it."""
    left, top, right, bottom = box_px
    height, width = shape
    if not (0 <= left < right <= width and 0 <= top < bottom <= height):
        raise errors.BadRequest(
            f"--box {left} {top} {right} {bottom} is no box in a picture of {width} x {height} pixels: X0 Y0"
            f" X1 Y1 with 0 <= X0 < X1 <= {width} and 0 <= Y0 < Y1 <= {height}"
        )
    return left // step, top // step, -(-right // step), -(-bottom // step)
