"""The input of a detector: an image at the size, and with the channels and the range, of its training."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

Bytes = NDArray[np.uint8]
Floats = NDArray[np.float32]

_GREY = 114
"""The colour of padding in the training of all YOLO models."""


class Placement(NamedTuple):
    """Where an image is in the input: x and y of the image times `scale`, plus `offset` [pixel]."""

    scale: tuple[float, float]
    offset: tuple[int, int]

    def to_image(self, corners: Floats) -> Floats:
        """Return boxes (N, 4) as x, y of two corners in the image, of boxes in the input."""
        offset, scale = np.array(self.offset * 2, np.float32), np.array(self.scale * 2, np.float32)
        return np.asarray((corners - offset) / scale, np.float32)


@dataclass(frozen=True)
class InputFormat:
    """How an image becomes an input.

    `padding`: at the bottom and right (`corner`), on both sides (`centre`), or none: the image is stretched.
    `bgr`: the order of the channels. Values from 0 to 255 are divided by `divisor`; then `mean` is subtracted
    and the rest divided by `deviation`, for each of red, green and blue.
    """

    padding: Literal["corner", "centre", "none"]
    bgr: bool = False
    divisor: float = 255.0
    mean: tuple[float, float, float] = (0.0, 0.0, 0.0)
    deviation: tuple[float, float, float] = (1.0, 1.0, 1.0)

    def prepare(self, colours: Bytes, height: int, width: int) -> tuple[Floats, Placement]:
        """Return an rgb image (H, W, 3) as an input (1, 3, `height`, `width`), and its place there."""
        rows, columns = colours.shape[:2]
        across, down = width, height
        if self.padding != "none":
            ratio = min(height / rows, width / columns)
            across, down = max(1, round(columns * ratio)), max(1, round(rows * ratio))
        left, top = ((width - across) // 2, (height - down) // 2) if self.padding == "centre" else (0, 0)
        resized = Image.fromarray(colours).resize((across, down), Image.Resampling.BILINEAR)
        canvas = np.full((height, width, 3), _GREY, np.uint8)
        canvas[top : top + down, left : left + across] = np.asarray(resized)
        planes = np.ascontiguousarray(canvas.transpose(2, 0, 1)[:: -1 if self.bgr else 1])
        values = planes.astype(np.float32)[None]
        mean, deviation = (
            np.array(of[:: -1 if self.bgr else 1], np.float32)[:, None, None]
            for of in (self.mean, self.deviation)
        )
        values *= 1.0 / (self.divisor * deviation)
        if any(self.mean):
            values -= mean / deviation
        return values, Placement((across / columns, down / rows), (left, top))


YOLO = InputFormat("centre")
"""Of Ultralytics' YOLO models: RGB from 0 to 1, padded on both sides."""
YOLOX = InputFormat("corner", bgr=True, divisor=1.0)
"""BGR from 0 to 255, padded at the bottom and right."""
STRETCHED = InputFormat("none")
"""Of RT-DETR: RGB from 0 to 1, stretched."""
IMAGENET = InputFormat("none", mean=(0.485, 0.456, 0.406), deviation=(0.229, 0.224, 0.225))
"""Of RF-DETR: RGB, stretched, normalised by the colours of ImageNet."""
