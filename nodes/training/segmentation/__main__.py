"""Train segmentation on renderings, and on recorded scenes if given."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np

from semmap.nodes.perception_node.segmentation.merge_model import SHIPPED, MergeModel, save
from semmap.nodes.training.segmentation.recorded_scenes import read_scenes
from semmap.nodes.training.segmentation.teach import learn, lessons, made_up


def main() -> None:
    """Render, train, and write the shipped model."""
    parser = argparse.ArgumentParser(prog="python -m semmap.nodes.training.segmentation", description=__doc__)
    parser.add_argument("--piles", type=int, default=500, help="rendered scenes")
    parser.add_argument("--recorded", type=Path, metavar="DIR", help="PCD files with a field label")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=SHIPPED)
    options = parser.parse_args()
    started = time.perf_counter()
    rng = np.random.default_rng(options.seed)
    piles = made_up(options.piles, rng)
    print(f"{len(piles)} piles after {time.perf_counter() - started:.0f} s")
    scenes = list(read_scenes(options.recorded)) if options.recorded and options.recorded.is_dir() else []
    heard = lessons(piles, scenes, rng)
    recorded = f"{len(scenes)} recorded ones of {options.recorded.name}/" if scenes else "no recorded ones"
    story = f"{len(piles)} rendered scenes of the model library, boxes and cylinders; {recorded}"
    save(MergeModel(learn(heard), story), options.out)
    print(f"{options.out} after {time.perf_counter() - started:.0f} s: {story}")


if __name__ == "__main__":
    main()
