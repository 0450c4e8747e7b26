"""A simulated table as perception sees it: `python -m benchmarks.perception.perceive_picture OUT.png`.

The things are our own models at other sizes and in other colours, some of them touching; the depth has the
noise of a Kinect. With `--frame DIR`, the frame is kept there, as `semmap perceive --frames DIR` reads it.
"""

from __future__ import annotations

import argparse
import json
import math
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from semmap.nodes.perception_node.datasets import perceive_folders
from semmap.nodes.perception_node.image_features.image_evidence import with_images
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.recognition.recognition_model import shipped
from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.sim_node.vision.view import look_at
from semmap.nodes.training.scenes.simulated_scenes import Item, Stage
from semmap.schemas.perception import FrameRow

_TABLE_M = (0.8, 1.3, 0.72)
_THINGS = {
    "cereals": (-0.24, -0.42, 0.5, 1.05),
    "laptop": (-0.12, 0.42, 1.75, 1.0),
    "wine_bottle": (-0.26, 0.08, 0.0, 0.95),
    "cup": (0.08, -0.28, 2.0, 1.1),
    "bowl": (0.02, 0.02, 0.0, 0.9),
    "apple": (0.2, -0.08, 0.0, 1.0),
    "banana": (0.27, 0.12, 0.9, 1.0),
    "can": (-0.08, -0.16, 0.0, 1.0),
    "book": (0.2, 0.38, 0.4, 1.0),
    "jar": (-0.1, 0.2, 0.0, 1.0),
    "knife": (0.28, -0.36, 1.4, 1.0),
    "toaster": (-0.25, -0.24, 1.57, 0.6),
}
"""Model: x, y [m], yaw [rad], and its size relative to the model's."""
_COLOUR, _DARK = "white", "black"


def frame() -> Cloud:
    """Return the table as one camera sees it."""
    stage = Stage()
    height = _TABLE_M[2]
    table = Item("table", "table", _TABLE_M, MODELS["table"].colour, (0.0, 0.0, 0.0), 0.0)
    things = [
        Item(kind, kind, _scaled(kind, scale), MODELS[kind].colour, (x, y, height + 0.001), yaw)
        for kind, (x, y, yaw, scale) in _THINGS.items()
    ]
    bodies = stage.show([table, *things])
    target = np.array([0.0, 0.0, height])
    eye = target + np.array([1.15, 0.0, 0.75])
    view = look_at(eye, target, 640, 480, math.radians(48))
    return stage.shoot(bodies, [view], np.random.default_rng(0)).clouds[0]


def _scaled(kind: str, scale: float) -> tuple[float, float, float]:
    x, y, z = MODELS[kind].size_m
    return x * scale, y * scale, z * scale


def write_frame(folder: Path, cloud: Cloud) -> None:
    """Write the three files of a frame. Raises ValueError for a cloud without colours or intrinsics."""
    if cloud.colors is None or cloud.intrinsics is None or cloud.map_from_camera is None:
        raise ValueError("the cloud has no image or no camera")
    folder.mkdir(parents=True, exist_ok=True)
    depth_mm = np.nan_to_num(cloud.points_camera[..., 2]) * 1e3
    Image.fromarray(cloud.colors).save(folder / "rgb.png")
    Image.fromarray(np.round(depth_mm).astype(np.uint16)).save(folder / "depth.png")
    k = cloud.intrinsics
    camera = {"fx": k[0, 0], "fy": k[1, 1], "cx": k[0, 2], "cy": k[1, 2]}
    camera["map_from_camera"] = cloud.map_from_camera.tolist()
    (folder / "camera.json").write_text(json.dumps(camera))


def drawn(image: Image.Image, row: FrameRow) -> Image.Image:
    """Return the image with the box, class and probability of each object."""
    canvas = image.resize((2 * image.width, 2 * image.height), Image.Resampling.LANCZOS)
    pen, font = ImageDraw.Draw(canvas), ImageFont.load_default(22)
    for one in row.objects:
        box = tuple(2 * side for side in one.box_px)
        pen.rectangle(box, outline=_COLOUR, width=2)
        text = f"{one.class_} {100 * one.probability:.0f} %"
        at = (box[0], max(0, box[1] - 26))
        pen.text(at, text, _COLOUR, font, stroke_width=3, stroke_fill=_DARK)
    return canvas


def main() -> None:
    """Render the frame, run perception on it, and draw the result."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--frame", type=Path)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = given.frame or Path(temporary) / "table"
        write_frame(folder, frame())
        (found,) = perceive_folders([folder], with_images(shipped()))
        drawn(Image.open(folder / "rgb.png"), found.row).save(given.out, optimize=True)
    for one in found.row.objects:
        print(f"{one.class_} {one.probability:.2f} {one.box_px}")


if __name__ == "__main__":
    main()
