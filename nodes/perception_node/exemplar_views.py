"""Finds the thing to be learned in a frame, and computes its view."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.image_features.efficientnet import FEATURES
from semmap.nodes.perception_node.image_features.image_evidence import ThingImages
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.files.frame_folders import frames_in, read_frame
from semmap.nodes.perception_node.pipeline import images_in, parts_in
from semmap.nodes.perception_node.recognition.features import features_of
from semmap.nodes.perception_node.recognition.free_standing import is_compact
from semmap.nodes.perception_node.recognition.joining import join_parts
from semmap.nodes.perception_node.recognition.recognition_model import RecognitionModel
from semmap.nodes.perception_node.recognition.sides import completed, side_features
from semmap.nodes.perception_node.recognition.similarity import views_of
from semmap.nodes.perception_node.recognition.vote import expected_sizes, leaf_probabilities
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.nodes.perception_node.views.merged_thing import Thing, thing_of
from semmap.nodes.perception_node.views.segmented_view import segment_cloud
from semmap.schemas import errors
from semmap.schemas.entities import Size
from semmap.schemas.wording import counted

BoxPx = tuple[int, int, int, int]
"""First column and row, and the column and row after the last [pixel]."""

_INSIDE = 0.7
"""A thing is selected by a box if this share of its pixels lies in it."""


@dataclass(frozen=True)
class ExemplarView:
    """The appearance of a thing in one frame.

    `features`: (WIDTH,). `size_m`: its size as estimated from this frame [m]. `image`: (FEATURES,) the
    features of its image, zeros without a photograph or the network.
    """

    features: Numbers
    size_m: Size
    image: Numbers = field(default_factory=lambda: np.zeros(FEATURES))


class ShownThing(NamedTuple):
    """A thing that was found in a cloud, and its pixels (H, W)."""

    thing: Thing
    own: NDArray[np.bool_]


def exemplar_view_of(
    thing: Thing, learnt: RecognitionModel, images: ThingImages | None = None
) -> ExemplarView:
    """Return the view of a thing as recognition stores it. `images`: those of the thing alone."""
    features = features_of([thing])
    expected = expected_sizes(leaf_probabilities(learnt, features), learnt.sizes_m)[0]
    x, y, z = completed(thing, side_features(thing, expected), learnt.sides).size_m.tolist()
    view = ExemplarView(views_of(features)[0], (max(x, y), min(x, y), z))
    return view if images is None else replace(view, image=images.features([0])[0])


def view_of_shown(shown: ShownThing, cloud: Cloud, learnt: RecognitionModel) -> ExemplarView:
    """Return the view of a thing that was found in a cloud, with its image if that is a photograph."""
    return exemplar_view_of(shown.thing, learnt, images_in([cloud], [shown.own.astype(np.int32)], 1, learnt))


def views_in_frames(
    folder: Path, learnt: RecognitionModel, box_px: BoxPx | None
) -> tuple[list[ExemplarView], tuple[str, ...]]:
    """Return a view of the thing from each frame of a dataset, and a note on frames without one.

    Raises BadFile if no frame shows a thing, with the reason for the first frame, and BadRequest for an
    invalid box.
    """
    views, wrong = list[ExemplarView](), list[errors.BadFile]()
    for frame_folder in frames_in(folder):
        try:
            frame = read_frame(frame_folder)
            box = None if box_px is None else _thinned(box_px, frame.shape, frame.step)
            shown = find_shown_thing(frame.cloud, learnt, box)
            if shown is None:
                what = "no compact free-standing thing" if box is None else "nothing in that box"
                raise errors.BadFile(f"{frame_folder.name}: {what}; {_HINT[box is None]}")
        except errors.BadFile as error:
            wrong.append(error)
            continue
        views.append(view_of_shown(shown, frame.cloud, learnt))
    if not views:
        raise wrong[0]
    if not wrong:
        return views, ()
    return views, (f"{counted(len(wrong), 'frame')} skipped; the first: {wrong[0].text}",)


_HINT = {
    True: "place it alone on a table, or select it with --box X0 Y0 X1 Y1",
    False: "--box X0 Y0 X1 Y1 must enclose the whole thing in the colour image [pixel]",
}


def find_shown_thing(
    cloud: Cloud, learnt: RecognitionModel, box_px: BoxPx | None = None
) -> ShownThing | None:
    """Return the largest compact thing in a cloud, or all that lies in a box; None if there is none."""
    parts = parts_in([segment_cloud(cloud)])

    def own_pixels(numbers: Sequence[int]) -> NDArray[np.bool_]:
        return np.isin(parts.labels[0], [number + 1 for number in numbers])

    if box_px is not None:
        inside = [
            n
            for n, share in enumerate(_shares(parts.labels[0], box_px))
            if share >= _INSIDE and not parts.things[n].carrier
        ]
        segments = [segment for n in inside for segment in parts.things[n].segments]
        return ShownThing(thing_of(segments, parts.supports), own_pixels(inside)) if segments else None
    things, _, members = join_parts(parts.things, parts.same_thing_logits, learnt, parts.join)
    compact = [n for n, thing in enumerate(things) if is_compact(thing)]
    best = max(compact, key=lambda n: things[n].count, default=None)
    return None if best is None else ShownThing(things[best], own_pixels(members[best]))


def _shares(labels: NDArray[np.int32], box_px: BoxPx) -> Sequence[float]:
    """Return for each part, from the first, the share of it in a box; `labels` (H, W) count from 1."""
    left, top, right, bottom = box_px
    count = int(labels.max(initial=0)) + 1
    total = np.bincount(labels.ravel(), minlength=count)
    within = np.bincount(labels[top:bottom, left:right].ravel(), minlength=count)
    return (within / np.maximum(total, 1))[1:].tolist()  # type: ignore[no-any-return]


def _thinned(box_px: BoxPx, shape: tuple[int, int], step: int) -> BoxPx:
    """Return a box for an image of which every `step`-th row and column is used.

    Raises BadRequest if invalid.
    """
    left, top, right, bottom = box_px
    height, width = shape
    if not (0 <= left < right <= width and 0 <= top < bottom <= height):
        raise errors.BadRequest(
            f"--box {left} {top} {right} {bottom} is invalid for an image of {width} x {height} pixels;"
            f" usage: --box X0 Y0 X1 Y1 with 0 <= X0 < X1 <= {width} and 0 <= Y0 < Y1 <= {height}"
        )
    return left // step, top // step, -(-right // step), -(-bottom // step)
