"""How well boxes of a detector select depth segments: `python -m benchmarks.perception.boxes`.

The boxes are those around the true masks, with sides that are moved at random; a mask is compared with the
true one. Recorded tables (`mosd`) and crowded rooms of the simulator.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.perception.recorded import data_folder
from benchmarks.perception.rooms import rooms
from benchmarks.perception.simulated import shots
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.masks import DetectorLabel, Masks
from semmap.nodes.perception_node.views.boxed import segments_in_boxes
from semmap.nodes.perception_node.views.segmented_view import segment_cloud
from semmap.nodes.training.segmentation.recorded_scenes import read_scenes

_MOVED = (0.0, 0.05, 0.15)
"""Greatest error of a side, as a share of the size of the box."""
_FEWEST = 150
"""Things of fewer pixels are left out."""
_SCORES = (0.4, 0.9)

Labelled = tuple[NDArray[np.int32], NDArray[np.int32]]
"""Our segments, and the true things, of each pixel (H, W)."""


def overlaps(found: Labelled, moved: float, rng: np.random.Generator) -> Iterator[float]:
    """Yield for each true thing how much the mask of its box overlaps it, as a share of their union."""
    segments, truth = found
    counts = np.bincount(truth.ravel())
    things = [n for n in np.flatnonzero(counts >= _FEWEST).tolist() if n]
    boxes = []
    for n in things:
        rows, columns = np.nonzero(truth == n)
        box = np.array([columns.min(), rows.min(), columns.max() + 1, rows.max() + 1], float)
        box += rng.uniform(-moved, moved, 4) * np.tile(box[2:] - box[:2], 2)
        left, top, right, bottom = np.clip(box, 0, [*truth.shape[::-1]] * 2).astype(int).tolist()
        boxes.append((left, top, right, bottom))
    labels = tuple(DetectorLabel("thing", float(rng.uniform(*_SCORES))) for _ in boxes)
    masks = segments_in_boxes(segments, Masks(np.zeros_like(truth), labels, boxes=tuple(boxes)))
    for number, n in enumerate(things, 1):
        own, true = masks == number, truth == n
        yield np.count_nonzero(own & true) / np.count_nonzero(own | true)


def main() -> None:
    """Print a table."""
    recorded = [(s.cloud, s.truth) for s in read_scenes(data_folder()) if s.cloud.organised]
    crowded = [
        pair
        for _, shot in shots(rooms(4, 8, crowded=True), seed=3)
        for pair in zip(shot.clouds, shot.owners, strict=True)
    ]
    print("| scenes | sides moved by up to | things | mean overlap | above 0.5 | no segment |")
    print("| --- | --- | --- | --- | --- | --- |")
    for name, pairs in (("recorded tables", recorded), ("crowded rooms", crowded)):
        _print_rows(name, pairs)


def _print_rows(name: str, pairs: Sequence[tuple[Cloud, NDArray[np.int32]]]) -> None:
    found = [(segment_cloud(cloud).labels, truth.astype(np.int32)) for cloud, truth in pairs]
    for moved in _MOVED:
        rng = np.random.default_rng(0)
        all_of = np.array([share for one in found for share in overlaps(one, moved, rng)])
        shares = f"{all_of.mean():.3f} | {(all_of > 0.5).mean():.3f} | {(all_of == 0.0).mean():.3f}"
        print(f"| {name} | {moved:.2f} | {len(all_of)} | {shares} |")


if __name__ == "__main__":
    main()
