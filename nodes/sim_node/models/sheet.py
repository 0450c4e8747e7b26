"""A contact sheet of all models: `python -m nodes.sim_node.models.sheet docs/models.png`."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import mujoco
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from nodes.sim_node.models.library import Model, build
from nodes.sim_node.models.model_table import MODELS
from nodes.sim_node.physics.build import add_part
from nodes.sim_node.vision.raycast import raycast
from nodes.sim_node.vision.view import FROM_THE_FRONT, overview

_CELL, _LABEL, _COLUMNS, _FINE = 150, 18, 13, 2
_PAPER, _INK = (242, 242, 240), (40, 40, 44)


def portrait(model: Model, pixels: int) -> Image.Image:
    """The model alone, filling a square picture."""
    spec = mujoco.MjSpec()
    body = spec.worldbody.add_body()
    for part in model.parts:
        add_part(body, part)
    compiled = spec.compile()
    data = mujoco.MjData(compiled)
    mujoco.mj_kinematics(compiled, data)
    x, y, z = model.size_m
    low, high = np.array([-x / 2, -y / 2, 0.0]), np.array([x / 2, y / 2, z])
    view = overview(low, high, _FINE * pixels, _FINE * pixels, FROM_THE_FRONT)
    rgb, depth, _ = raycast(compiled, data, view)
    rgb[depth == 0.0] = _PAPER
    return Image.fromarray(rgb).resize((pixels, pixels), Image.Resampling.BOX)


def contact_sheet(names: list[str]) -> Image.Image:
    """Portraits in rows, each with its name; every one as large as fits, so sizes are not to scale."""
    rows = math.ceil(len(names) / _COLUMNS)
    sheet = Image.new("RGB", (_COLUMNS * _CELL, rows * (_CELL + _LABEL)), _PAPER)
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(12)
    for place, name in enumerate(names):
        left, top = place % _COLUMNS * _CELL, place // _COLUMNS * (_CELL + _LABEL)
        sheet.paste(portrait(build(name, None), _CELL - 12), (left + 6, top + 4))
        draw.text((left + _CELL / 2, top + _CELL), name, fill=_INK, font=font, anchor="mt")
    return sheet


def main() -> None:
    """Write the sheet of all models to the file named on the command line."""
    target = Path(sys.argv[1])
    target.parent.mkdir(parents=True, exist_ok=True)
    contact_sheet(list(MODELS)).save(target, optimize=True)


if __name__ == "__main__":
    main()
