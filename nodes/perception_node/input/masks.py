"""Masks of an external detector: the thing of each pixel, and its label."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from semmap.schemas.perception import MaskImage, MaskRun

_MOST = 65_535
"""Maximum number of things in one image."""

Box = tuple[int, int, int, int]
"""First column and row of a box, and those after the last [pixel]."""


@dataclass(frozen=True)
class DetectorLabel:
    """The label of a detector for a thing, and its score, 0 to 1."""

    label: str
    score: float


@dataclass(frozen=True)
class Masks:
    """The masks of one image.

    In `labels` (H, W), n is the n-th thing and 0 none; `detector_labels` are their labels. With `alone`,
    there are no other things. `boxes`: of a detector without masks, the box of each thing; then `labels`
    are 0.
    """

    labels: NDArray[np.int32]
    detector_labels: tuple[DetectorLabel | None, ...]
    alone: bool = False
    boxes: tuple[Box, ...] = ()

    def thinned(self, step: int) -> Masks:
        """Return the masks of every `step`-th row and column."""
        return replace(self, labels=np.ascontiguousarray(self.labels[::step, ::step]))


def masks_from_runs(masks: Sequence[MaskRun], height: int, width: int) -> Masks:
    """Decode masks in the format of COCO; where they overlap, the higher score wins.

    Raises ValueError for a damaged mask or another size.
    """
    labels = np.zeros((height, width), np.int32)
    for n in sorted(range(len(masks)), key=lambda n: masks[n].score):
        labels[_decoded(masks[n], height, width)] = n + 1
    return Masks(
        labels, tuple(DetectorLabel(mask.label, mask.score) if mask.label else None for mask in masks)
    )


def masks_from_stack(
    stack: NDArray[np.bool_], names: Sequence[str] = (), scores: Sequence[float] = ()
) -> Masks:
    """Combine one mask for each thing (N, H, W); where they overlap, the higher score wins.

    Raises ValueError if names or scores are not as many as the masks.
    """
    count, height, width = stack.shape
    if count > _MOST:
        raise ValueError(f"there are {count} masks; the maximum is {_MOST}")
    for kind, given in (("names", names), ("scores", scores)):
        if given and len(given) != count:
            raise ValueError(f"there are {count} masks and {len(given)} {kind}; each mask needs one")
    sure = scores or [1.0] * count
    if not all(0.0 <= score <= 1.0 for score in sure):  # NaN is not
        raise ValueError("scores must be from 0 to 1")
    labels = np.zeros((height, width), np.int32)
    for n in sorted(range(count), key=lambda n: sure[n]):
        labels[np.asarray(stack[n])] = n + 1
    found = zip(names or [""] * count, sure, strict=True)
    return Masks(labels, tuple(DetectorLabel(name, score) if name else None for name, score in found))


def masks_from_image(image: MaskImage, height: int, width: int) -> Masks:
    """Decode masks from an image of 16-bit numbers. Raises ValueError if its size differs."""
    if len(image.labels) != 2 * height * width:
        raise ValueError(
            f"{len(image.labels)} bytes are not a label image of {width} x {height} pixels, which has"
            f" {2 * height * width}"
        )
    numbers = np.frombuffer(image.labels, "<u2").reshape(height, width)
    return masks_from_numbers(numbers, image.names, image.scores)


def masks_from_numbers(
    numbers: NDArray[np.integer], names: Sequence[str] = (), scores: Sequence[float] = ()
) -> Masks:
    """Decode masks from a label image (H, W): 0 for none, n for the thing named `names[n - 1]`.

    Raises ValueError if some numbers have names and others do not.
    """
    if numbers.ndim != 2 or numbers.min(initial=0) < 0:
        raise ValueError("a label image must have one number per pixel: 0 for none, n for the n-th thing")
    count = int(numbers.max(initial=0))
    if count > _MOST:
        raise ValueError(f"the label image has {count} things; the maximum is {_MOST}")
    if names and count > len(names):
        raise ValueError(f"the label image has {count} things, but {len(names)} names")
    if scores and len(scores) != len(names):
        raise ValueError(f"there are {len(names)} names and {len(scores)} scores; each name needs one")
    sure = scores or [1.0] * len(names)
    labels = [DetectorLabel(name, score) if name else None for name, score in zip(names, sure, strict=True)]
    return Masks(numbers.astype(np.int32), (*labels, *[None] * (count - len(labels))))


def _decoded(mask: MaskRun, height: int, width: int) -> NDArray[np.bool_]:
    """Decode a run-length code to (H, W): column by column, starting with background."""
    if tuple(mask.size) != (height, width):
        rows, columns = mask.size
        raise ValueError(f"a mask has {columns} x {rows} pixels, the image {width} x {height}")
    runs = _counts(mask.counts) if isinstance(mask.counts, str) else mask.counts
    counts = np.array([run if 0 <= run <= height * width else -1 for run in runs], np.int64)
    if (counts < 0).any() or counts.sum() != height * width:
        raise ValueError(f"the runs of a mask add up to {sum(runs)} pixels, not to {height * width}")
    own = np.arange(len(counts)) % 2 == 1
    return np.asarray(np.repeat(own, counts).reshape(width, height).T)


def _counts(text: str) -> list[int]:
    """Decode the compressed runs of COCO: six bits per character, lowest first, runs as differences."""
    found: list[int] = []
    at = 0
    while at < len(text):
        value, shift, more = 0, 0, True
        while more:
            if at == len(text):
                raise ValueError("the counts of a mask are truncated")
            code = ord(text[at]) - 48
            if not 0 <= code < 64:
                raise ValueError(f"the counts of a mask contain the invalid character '{text[at]}'")
            value |= (code & 0x1F) << shift
            more = bool(code & 0x20)
            at, shift = at + 1, shift + 5
            if not more and code & 0x10:
                value |= -1 << shift
        found.append(value + (found[-2] if len(found) > 2 else 0))
    return found
