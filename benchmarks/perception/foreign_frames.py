"""Frames of third-party objects: textured meshes in front of the simulated camera.

    python -m benchmarks.perception.foreign_frames OUT [--things DIR] [--alone 4] [--mixed 60] [--seed 1]

A folder a frame, as `semmap perceive --frames` reads them, with `mask.png` and `truth.json` beside. Things
stand on a table of any colour, alone or eight together, seen from one and from two metres, with noise.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from semmap.nodes.sim_node.vision.view import View
from semmap.nodes.training.scenes.foreign_things import foreign_things
from semmap.nodes.training.scenes.textured_scenes import HEIGHT, WIDTH, Stood, Studio, distance_m, scenes


def write_frame(
    folder: Path,
    shot: tuple[View, NDArray[np.uint8], NDArray[np.float32], NDArray[np.uint8]],
    kind: str,
    distance: str,
    stood: Sequence[Stood],
) -> None:
    """Write the files of one frame."""
    view, rgb, depth, mask = shot
    folder.mkdir(parents=True, exist_ok=True)
    Image.fromarray(rgb).save(folder / "rgb.png")
    Image.fromarray(np.round(depth * 1e3).astype(np.uint16)).save(folder / "depth.png")
    Image.fromarray(mask).save(folder / "mask.png")
    k = view.intrinsics
    camera = {"fx": k[0, 0], "fy": k[1, 1], "cx": k[0, 2], "cy": k[1, 2], "width": WIDTH, "height": HEIGHT}
    camera["map_from_camera"] = view.map_from_camera.tolist()
    (folder / "camera.json").write_text(json.dumps(camera))
    objects = [
        {
            "name": one.thing.name,
            "fits": one.thing.classes,
            "new": one.thing.new,
            "group": one.thing.group,
            "size_m": one.thing.size_m,
            "largest_m": max(one.thing.size_m),
            "pose": {"position_m": [one.x, one.y, one.z]},
            "pixels": int((mask == n).sum()),
            "pixels_with_depth": int(((mask == n) & (depth > 0)).sum()),
        }
        for n, one in enumerate(stood, 1)
    ]
    truth = {
        "kind": kind,
        "half": "",
        "distance": distance,
        "look": None,
        "mask": "mask.png",
        "objects": objects,
    }
    (folder / "truth.json").write_text(json.dumps(truth))


def main() -> None:
    """Render the frames and print the folder."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("out", type=Path)
    parser.add_argument("--things", type=Path, default=Path("../shared/data/foreign"))
    parser.add_argument("--alone", type=int, default=4, help="frames of each thing alone")
    parser.add_argument("--mixed", type=int, default=60, help="frames with several things")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rng, studio = np.random.default_rng(options.seed), Studio()
    found = foreign_things(options.things)
    for number, (kind, stood) in enumerate(scenes(found, options.alone, options.mixed, rng)):
        distance = "near" if number % 2 == 0 else "far"
        shot = studio.shoot(stood, distance_m(number, rng), rng)
        write_frame(options.out / f"{number:04d}", shot, kind, distance, stood)
    print(f"{options.out}: {number + 1} frames")


if __name__ == "__main__":
    main()
