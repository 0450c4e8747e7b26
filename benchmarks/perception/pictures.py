"""Labels over recorded and simulated scenes: `python -m benchmarks.perception.pictures OUT.png`."""

from __future__ import annotations

import argparse
import colorsys
from collections.abc import Sequence
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from benchmarks.perception.recorded import data_folder
from benchmarks.perception.rooms import rooms
from benchmarks.perception.simulated import shots
from semmap.nodes.perception_node.pipeline import FrameResult, observe_clouds
from semmap.nodes.perception_node.recognition.recognition_model import shipped
from semmap.nodes.perception_node.segmentation import segment
from semmap.nodes.perception_node.segmentation.merge_model import MergeModel
from semmap.nodes.perception_node.segmentation.merging import Judge
from semmap.nodes.training.segmentation.recorded_scenes import Scene, read_scenes
from semmap.nodes.training.segmentation.teach import learn, lessons, made_up

Picture = NDArray[np.uint8]

_ROOMS = ((7, False), (8, True), (9, True))
_DIM, _TINT = 0.5, 0.6
_GOLDEN = 0.618034  # neighbours in number are far apart in hue


def overlay(colors: Picture, labels: NDArray[np.int32]) -> Picture:
    """Return the image (H, W, 3) with one tint per label (H, W), dimmed elsewhere."""
    count = int(labels.max(initial=0)) + 1
    tints = np.array([colorsys.hsv_to_rgb(n * _GOLDEN % 1, 0.85, 1.0) for n in range(count)]) * 255
    tinted = (1 - _TINT) * colors + _TINT * tints[labels]
    return np.where((labels > 0)[..., None], tinted, _DIM * colors).astype(np.uint8)


def recorded_row(scenes: Sequence[Scene], judge: Judge) -> Picture:
    """Return each scene's image with its labels, side by side at half the size."""
    panels = [overlay(_colors(scene), segment(scene.cloud, judge).labels)[::2, ::2] for scene in scenes]
    return np.concatenate(panels, axis=1)


def simulated_row(width: int) -> Picture:
    """Return three simulated rooms (one loose, two crowded) with predicted classes; `width` in pixels."""
    chosen = chain(*(rooms(1, seed, crowded=crowded) for seed, crowded in _ROOMS))
    panels = []
    for _, shot in shots(chosen, seed=3):
        seen = observe_clouds(shot.clouds, shipped())
        panels.append(_named(overlay(np.asarray(shot.clouds[0].colors), seen.labels[0]), seen))
    row = Image.fromarray(np.concatenate(panels, axis=1))
    return np.asarray(row.resize((width, row.height * width // row.width), Image.Resampling.LANCZOS))


def _named(picture: Picture, seen: FrameResult) -> Picture:
    """Write the class of each observation at the centre of its pixels."""
    image = Image.fromarray(picture)
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(20)
    for number, observation in enumerate(seen.observations.observations, 1):
        rows, columns = np.nonzero(seen.labels[0] == number)
        if len(rows):
            at = (float(np.median(columns)), float(np.median(rows)))
            draw.text(at, observation.class_, "white", font, anchor="mm", stroke_width=2, stroke_fill="black")
    return np.asarray(image)


def _colors(scene: Scene) -> Picture:
    if scene.cloud.colors is None:
        return np.full((*scene.truth.shape, 3), 128, np.uint8)
    return scene.cloud.colors


def main() -> None:
    """Draw scenes segmented by a model trained on all the others."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.perception.pictures", description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--scenes", default="learn24,learn31,learn33")
    parser.add_argument("--recorded", type=Path, default=data_folder())
    parser.add_argument("--piles", type=int, default=300)
    words = parser.parse_args()
    scenes, rng = list(read_scenes(words.recorded)), np.random.default_rng(1)
    drawn = words.scenes.split(",")
    heard = lessons(made_up(words.piles, rng), (s for s in scenes if s.name not in drawn), rng)
    row = recorded_row([s for s in scenes if s.name in drawn], MergeModel(learn(heard), ""))
    Image.fromarray(np.concatenate([row, simulated_row(row.shape[1])])).save(words.out)


if __name__ == "__main__":
    main()
