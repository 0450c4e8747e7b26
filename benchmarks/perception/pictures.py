"""Labels over recorded scenes: `python -m benchmarks.perception.pictures OUT.png [--scenes NAME,...]`."""

from __future__ import annotations

import argparse
import colorsys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from benchmarks.perception.recorded import data_folder
from nodes.perception_node.segmentation import segment
from nodes.perception_node.segmentation.learnt import MergeModel
from nodes.perception_node.segmentation.merging import Judge
from nodes.training.segmentation.recorded import Scene, read_scenes
from nodes.training.segmentation.teach import learn, lessons, made_up

Picture = NDArray[np.uint8]

_DIM, _TINT = 0.5, 0.6
_GOLDEN = 0.618034  # neighbours in number are far apart in hue


def overlay(colors: Picture, labels: NDArray[np.int32]) -> Picture:
    """The picture (H, W, 3) with a tint of its own for each label (H, W), and dimmed where there is none."""
    count = int(labels.max(initial=0)) + 1
    tints = np.array([colorsys.hsv_to_rgb(n * _GOLDEN % 1, 0.85, 1.0) for n in range(count)]) * 255
    tinted = (1 - _TINT) * colors + _TINT * tints[labels]
    return np.where((labels > 0)[..., None], tinted, _DIM * colors).astype(np.uint8)


def recorded_row(scenes: Sequence[Scene], judge: Judge) -> Picture:
    """Each scene's labels over its picture, side by side, at half the size."""
    panels = [overlay(_colors(scene), segment(scene.cloud, judge).labels)[::2, ::2] for scene in scenes]
    return np.concatenate(panels, axis=1)


def _colors(scene: Scene) -> Picture:
    if scene.cloud.colors is None:
        return np.full((*scene.truth.shape, 3), 128, np.uint8)
    return scene.cloud.colors


def main() -> None:
    """Draw scenes by a model that learnt from all the others."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.perception.pictures", description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--scenes", default="learn24,learn33,learn36")
    parser.add_argument("--recorded", type=Path, default=data_folder())
    parser.add_argument("--piles", type=int, default=300)
    words = parser.parse_args()
    scenes, rng = list(read_scenes(words.recorded)), np.random.default_rng(1)
    drawn = words.scenes.split(",")
    heard = lessons(made_up(words.piles, rng), (s for s in scenes if s.name not in drawn), rng)
    row = recorded_row([s for s in scenes if s.name in drawn], MergeModel(learn(heard), ""))
    Image.fromarray(row).save(words.out)


if __name__ == "__main__":
    main()
