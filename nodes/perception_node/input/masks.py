"""Masks of somebody else's detector: whose each pixel is, and what it is taken for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from semmap.schemas.perception import MaskImage, MaskRun

_MOST = 65_535
"""Things in one picture."""


@dataclass(frozen=True)
class DetectorLabel:
    """What a detector takes a thing for, in its own words, and how sure it is, 0 to 1."""

    label: str
    score: float


@dataclass(frozen=True)
class Masks:
    """`labels`: (H, W) n where the n-th thing is seen, 0 for none; `said`: of each what it is taken for.

    `alone`: there is nothing else to be found.
    """

    labels: NDArray[np.int32]
    said: tuple[DetectorLabel | None, ...]
    alone: bool = False

    def thinned(self, step: int) -> Masks:
        """The same for every `step`-th row and column."""
        return replace(self, labels=np.ascontiguousarray(self.labels[::step, ::step]))


def masks_from_runs(masks: Sequence[MaskRun], height: int, width: int) -> Masks:
    """Masks as COCO writes them; where several overlap, the surer one is before the others.

    Raises ValueError where one is of another size or is damaged.
    """
    labels = np.zeros((height, width), np.int32)
    for n in sorted(range(len(masks)), key=lambda n: masks[n].score):
        labels[_decoded(masks[n], height, width)] = n + 1
    return Masks(
        labels, tuple(DetectorLabel(mask.label, mask.score) if mask.label else None for mask in masks)
    )


def masks_from_image(image: MaskImage, height: int, width: int) -> Masks:
    """Masks as one image of 16-bit numbers. Raises ValueError where it does not fit the picture."""
    if len(image.labels) != 2 * height * width:
        raise ValueError(
            f"{len(image.labels)} bytes are no label image of {width} x {height} pixels, which has"
            f" {2 * height * width}"
        )
    numbers = np.frombuffer(image.labels, "<u2").reshape(height, width)
    return masks_from_numbers(numbers, image.names, image.scores)


def masks_from_numbers(
    numbers: NDArray[np.integer], names: Sequence[str] = (), scores: Sequence[float] = ()
) -> Masks:
    """Masks from a label image (H, W): 0 for none, n for the thing that is called `names[n - 1]`.

    Raises ValueError where a number has no name although others do.
    """
    if numbers.ndim != 2 or numbers.min(initial=0) < 0:
        raise ValueError("a label image has one number a pixel: 0 for none, n for the n-th thing")
    count = int(numbers.max(initial=0))
    if count > _MOST:
        raise ValueError(f"the label image has a thing number {count}; there may be {_MOST}")
    if names and count > len(names):
        raise ValueError(f"the label image has a thing number {count}, but only {len(names)} names")
    if scores and len(scores) != len(names):
        raise ValueError(f"there are {len(names)} names and {len(scores)} scores; each name needs one")
    sure = scores or [1.0] * len(names)
    said = [DetectorLabel(name, score) if name else None for name, score in zip(names, sure, strict=True)]
    return Masks(numbers.astype(np.int32), (*said, *[None] * (count - len(said))))


def _decoded(mask: MaskRun, height: int, width: int) -> NDArray[np.bool_]:
    """(H, W) of a run-length code: column after column, first how many pixels are not of it."""
    if tuple(mask.size) != (height, width):
        rows, columns = mask.size
        raise ValueError(f"a mask is of {columns} x {rows} pixels, the picture of {width} x {height}")
    told = _counts(mask.counts) if isinstance(mask.counts, str) else mask.counts
    counts = np.array([run if 0 <= run <= height * width else -1 for run in told], np.int64)
    if (counts < 0).any() or counts.sum() != height * width:
        raise ValueError(f"the runs of a mask add up to {sum(told)} pixels, not to {height * width}")
    own = np.arange(len(counts)) % 2 == 1
    return np.asarray(np.repeat(own, counts).reshape(width, height).T)


def _counts(text: str) -> list[int]:
    """The runs in COCO's compressed text: six bits a character, the lowest first, runs as differences."""
    found: list[int] = []
    at = 0
    while at < len(text):
        value, shift, more = 0, 0, True
        while more:
            if at == len(text):
                raise ValueError("the text of a mask's runs is cut off")
            code = ord(text[at]) - 48
            if not 0 <= code < 64:
                raise ValueError(
                    f"the text of a mask's runs has a '{text[at]}', which is none of its letters"
                )
            value |= (code & 0x1F) << shift
            more = bool(code & 0x20)
            at, shift = at + 1, shift + 5
            if not more and code & 0x10:
                value |= -1 << shift
        found.append(value + (found[-2] if len(found) > 2 else 0))
    return found
