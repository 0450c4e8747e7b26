"""The sixty situations as one picture: `python -m benchmarks.relations.picture docs/relations.png`."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import mujoco
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from benchmarks.relations.situations import SITUATIONS, Said, Situation
from nodes.kb_node.relations.geometry.solids import Solid, solid_of
from nodes.sim_node.models.library import build
from nodes.sim_node.models.parts import Colour, Part, Role, ball, box
from nodes.sim_node.physics.build import add_part
from nodes.sim_node.vision.raycast import raycast
from nodes.sim_node.vision.view import FROM_THE_FRONT, overview
from ontology.model_shapes import shapes
from schemas.entities import Entity

_WIDTH, _HEIGHT, _LINE, _LINES, _COLUMNS, _FINE = 272, 210, 15, 7, 6, 2
_PAPER, _INK, _QUIET, _RULE = (250, 250, 248), (30, 30, 34), (105, 105, 112), (222, 222, 218)
_FLOOR: Colour = (0.86, 0.85, 0.82)
_PLACES: tuple[Colour, ...] = ((0.78, 0.84, 0.90), (0.90, 0.84, 0.74), (0.78, 0.88, 0.78))
_BOXES: tuple[Colour, ...] = ((0.72, 0.55, 0.36), (0.45, 0.58, 0.66), (0.62, 0.66, 0.42))
_ROUND_ABOUT = np.array([0.22, 0.22, 0.12])
"""How much of what is around small things is shown [m]."""
_NOWHERE: Colour = (0.85, 0.20, 0.55)
_WORDS = {
    "isOn": "on", "isInside": "inside", "isLocatedIn": "in", "isAttachedTo": "attached to",
    "isUnder": "under", "isAbove": "above", "isNextTo": "next to", "isBetween": "between",
    "touches": "touches",
}  # fmt: skip


def tile(situation: Situation) -> Image.Image:
    """One situation, drawn, with its title and what is said of it."""
    made = Image.new("RGB", (_WIDTH, _HEIGHT + _LINES * _LINE + 8), _PAPER)
    made.paste(view_of(situation), (0, 0))
    draw = ImageDraw.Draw(made)
    draw.text((10, _HEIGHT + 6), situation.title, fill=_INK, font=ImageFont.load_default(13))
    for row, sentence in enumerate(sentences(situation)):
        at = (10, _HEIGHT + 8 + (row + 1) * _LINE)
        draw.text(at, sentence, fill=_QUIET, font=ImageFont.load_default(12))
    draw.rectangle((0, 0, made.width - 1, made.height - 1), outline=_RULE)
    return made


def sentences(situation: Situation) -> list[str]:
    """What is said, shortly."""
    said = sorted(situation.said) + sorted(situation.also)
    seen: set[Said] = set()
    told: list[str] = []
    for name, relation, other in said:
        if relation in ("isNextTo", "touches") and (other, relation, name) in seen:
            continue
        seen.add((name, relation, other))
        told.append(f"{name} {_WORDS[relation]} {other}" + (" and cup3" if relation == "isBetween" else ""))
    return told or ["on nothing, inside nothing"]


def view_of(situation: Situation) -> Image.Image:
    """The things themselves; what has something inside it is cut open in front."""
    entities = [entity for entity in situation.things if entity.pose is not None]
    solids = [solid for entity in entities if (solid := solid_of(entity)) is not None]
    ox, oy, _ = solids[0].position if abs(solids[0].position[0]) > 1000.0 else (0.0, 0.0, 0.0)
    opened = {other for _, relation, other in situation.said if relation == "isInside"}
    spec = mujoco.MjSpec()
    boxes = iter(_BOXES * 3)
    places = iter(_PLACES)
    for entity, solid in zip(entities, solids, strict=True):
        x, y, z = solid.position
        assert entity.pose is not None
        body = spec.worldbody.add_body(pos=(x - ox, y - oy, z), quat=entity.pose.orientation_wxyz)
        for part in _parts(entity, solid, opened, next(places if entity.place else boxes, _FLOOR)):
            add_part(body, part)
    low = np.min([(s.bounds[0] - ox, s.bounds[1] - oy, 0.0) for s in solids], axis=0)
    high = np.max([(s.bounds[2] - ox, s.bounds[3] - oy, _height(s)) for s in solids], axis=0)
    middle, reach = (low + high) / 2, high - low
    add_part(
        spec.worldbody.add_body(),
        box((reach[0] + 0.5, reach[1] + 0.5, 0.02), (middle[0], middle[1], -0.04), _FLOOR),
    )
    compiled = spec.compile()
    data = mujoco.MjData(compiled)
    mujoco.mj_kinematics(compiled, data)
    if close := _close(situation, solids):
        offset = (ox, oy, 0.0)
        low = np.maximum(
            low, np.min([(*s.bounds[:2], s.bottom) for s in close], axis=0) - offset - _ROUND_ABOUT
        )
        high = np.minimum(
            high, np.max([(*s.bounds[2:], s.top) for s in close], axis=0) - offset + _ROUND_ABOUT
        )
    view = overview(low, high, _FINE * _WIDTH, _FINE * _HEIGHT, FROM_THE_FRONT)
    rgb, depth, _ = raycast(compiled, data, view)
    rgb[depth == 0.0] = _PAPER
    return Image.fromarray(rgb).resize((_WIDTH, _HEIGHT), Image.Resampling.BOX)


def _close(situation: Situation, solids: list[Solid]) -> list[Solid]:
    """What the picture is about, if all that is said of it is that it is on or inside something larger."""
    relations = {relation for _, relation, _ in (*situation.said, *situation.also)}
    small = [solid for solid in solids if max(solid.size) < 0.5 * max(max(s.size) for s in solids)]
    carried = {name for name, _, _ in situation.said}
    if relations & {"isUnder", "isAbove", "isLocatedIn", "isAttachedTo"} or not small:
        return []
    return small if {solid.name for solid in small} <= carried else []


def _height(solid: Solid) -> float:
    return 0.01 if solid.is_place else solid.top


def _parts(entity: Entity, solid: Solid, opened: set[str], colour: Colour) -> list[Part]:
    x, y, _ = solid.size
    if entity.place:
        return [box((x - 0.04, y - 0.04, 0.02), (0.0, 0.0, -0.015), colour)]
    if not solid.is_measured:
        return [ball((0.08, 0.08, 0.08), (0.0, 0.0, 0.04), _NOWHERE)]
    if not entity.model:
        return [box(solid.size, (0.0, 0.0, solid.size[2] / 2), colour)]
    parts = [part for part in build(entity.model, entity.size_m).parts if part.role is not Role.FELT]
    if entity.name in opened and not any(inner.open for inner in shapes()[entity.model].interiors):
        return _cut_open(entity)
    return parts


def _cut_open(entity: Entity) -> list[Part]:
    """The walls and boards of a closed thing without its front."""
    felt = [part for part in build(entity.model, entity.size_m).parts if part.role is not Role.SEEN]
    x = max(float(part.centre[0] + part.reach()[0]) for part in felt)
    behind = [part for part in felt if part.centre[0] + part.reach()[0] < x - 0.03 or part.reach()[0] > 0.05]
    seen = [part.colour for part in build(entity.model, entity.size_m).parts if part.role is Role.SEEN]
    return [Part(p.shape, p.half, p.centre, seen[0], p.turn) for p in behind]


def sheet() -> Image.Image:
    """All situations in rows."""
    tiles = [tile(situation) for situation in SITUATIONS]
    width, height = tiles[0].size
    rows = math.ceil(len(tiles) / _COLUMNS)
    made = Image.new("RGB", (_COLUMNS * width, rows * height), _PAPER)
    for number, one in enumerate(tiles):
        made.paste(one, (number % _COLUMNS * width, number // _COLUMNS * height))
    return made


def main() -> None:
    """Write the picture to the file named on the command line."""
    sheet().quantize(128).save(Path(sys.argv[1]), optimize=True)


if __name__ == "__main__":
    main()
