"""Renders a contact sheet of all models.

Usage: `python -m semmap.nodes.sim_node.models.contact_sheet docs/models.png`.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import mujoco
from PIL import Image, ImageDraw, ImageFont

from semmap.nodes.sim_node.models.library import Model, build
from semmap.nodes.sim_node.models.parts import Part, bounds, moved
from semmap.nodes.sim_node.models.variety_table import KINDS
from semmap.nodes.sim_node.physics.build import add_part
from semmap.nodes.sim_node.vision.raycast import raycast
from semmap.nodes.sim_node.vision.view import FROM_THE_FRONT, overview

_CELL, _LABEL, _COLUMNS, _FINE = 150, 18, 13, 2
_PAPER, _INK = (242, 242, 240), (40, 40, 44)


def portrait(model: Model, pixels: int, *, is_open: bool | None = None) -> Image.Image:
    """Render a model in a square image: as designed, or with all its joints open or closed."""
    spec = mujoco.MjSpec()
    body = spec.worldbody.add_body()
    parts = model.parts if is_open is None else [_stands(part, is_open=is_open) for part in model.parts]
    for part in parts:
        add_part(body, part)
    compiled = spec.compile()
    data = mujoco.MjData(compiled)
    mujoco.mj_kinematics(compiled, data)
    low, high = bounds(parts)
    view = overview(low, high, _FINE * pixels, _FINE * pixels, FROM_THE_FRONT)
    rgb, depth, _ = raycast(compiled, data, view)
    rgb[depth == 0.0] = _PAPER
    return Image.fromarray(rgb).resize((pixels, pixels), Image.Resampling.BOX)


def _stands(part: Part, *, is_open: bool) -> Part:
    """Return a part with its joint at one end."""
    joint = part.joint
    if joint is None or joint.range is None or joint.closed is None:
        return part
    lower, upper = joint.range
    return moved(part, (upper if joint.closed == lower else lower) if is_open else joint.closed)


def contact_sheet(names: list[str]) -> Image.Image:
    """Arrange portraits in rows, each with its name. Each is scaled to fit.

    Models that open are shown as designed, and again in separate rows, open and closed.
    """
    cells: list[tuple[str, Image.Image]] = [(name, portrait(build(name, None), _CELL - 12)) for name in names]
    opening = [model for name in names if (model := build(name, None)).leaves]
    cells += [("", Image.new("RGB", (1, 1), _PAPER))] * (-len(cells) % _COLUMNS)
    for model in opening:
        for is_open, word in ((False, "shut"), (True, "open")):
            cells.append((f"{model.name}, {word}", portrait(model, _CELL - 12, is_open=is_open)))
    rows = math.ceil(len(cells) / _COLUMNS)
    sheet = Image.new("RGB", (_COLUMNS * _CELL, rows * (_CELL + _LABEL)), _PAPER)
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(12)
    for place, (name, picture) in enumerate(cells):
        left, top = place % _COLUMNS * _CELL, place // _COLUMNS * (_CELL + _LABEL)
        sheet.paste(picture, (left + 6, top + 4))
        draw.text((left + _CELL / 2, top + _CELL), name, fill=_INK, font=font, anchor="mt")
    return sheet


def main() -> None:
    """Write the contact sheet to the file named on the command line."""
    target = Path(sys.argv[1])
    target.parent.mkdir(parents=True, exist_ok=True)
    contact_sheet(list(KINDS)).save(target, optimize=True)


if __name__ == "__main__":
    main()
