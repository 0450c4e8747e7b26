"""The sixty situations as one picture: `python -m benchmarks.relations.picture docs/relations.png`."""

from __future__ import annotations

import sys
from pathlib import Path

import mujoco
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from benchmarks.relations.situations import SITUATIONS, Said, Situation
from nodes.kb_node.relations.geometry.solids import Solid, solid_of
from nodes.sim_node.bodies import Floats
from nodes.sim_node.models.library import build
from nodes.sim_node.models.parts import Colour, Part, Role, ball, box
from nodes.sim_node.physics.build import add_part
from nodes.sim_node.vision.raycast import raycast
from nodes.sim_node.vision.view import FROM_THE_FRONT, View, overview
from ontology.model_shapes import shapes
from schemas.entities import Entity

_WIDTH, _HEIGHT, _LINE, _COLUMNS, _FINE = 320, 232, 18, 6, 2
_PAPER, _INK, _QUIET, _RULE = (250, 250, 248), (24, 24, 28), (70, 70, 78), (205, 205, 200)
_LABEL = (255, 255, 236)
_FLOOR: Colour = (0.86, 0.85, 0.82)
_PLACES: tuple[Colour, ...] = ((0.78, 0.84, 0.90), (0.90, 0.84, 0.74), (0.78, 0.88, 0.78))
_BOXES: tuple[Colour, ...] = ((0.72, 0.55, 0.36), (0.45, 0.58, 0.66), (0.62, 0.66, 0.42))
_ROUND_ABOUT = (0.06, 0.16)
"""How much of what is around small things is shown, at least and at most [m]."""
_FROM_THE_SIDE, _FROM_ABOVE = (0.90, -0.42, 0.16), (0.55, -0.30, 0.90)
_SEEN_FROM = {
    "let go two centimetres above it": _FROM_THE_SIDE,
    "sunk a centimetre into it": _FROM_THE_SIDE,
    "in the air above it": (0.80, -0.50, 0.32),
    "under it": (0.80, -0.50, 0.22),
    "beside it, at its height": (0.25, -0.90, 0.35),
    "half over the edge": (0.35, -0.90, 0.30),
    "nearly all of it over the edge": (0.35, -0.90, 0.30),
    "tilted a little": (0.30, -0.90, 0.22),
    "a large one on a small one": _FROM_THE_SIDE,
    "a board across two boxes": (0.90, -0.42, 0.30),
    "over the gap of two tables": (0.80, -0.30, 0.40),
    "a book leaning on a box": (0.25, -0.90, 0.30),
    "a tray tilted over the edge of a box": (0.25, -0.90, 0.30),
    "a tray on two cans": _FROM_THE_SIDE,
    "an orange in a bowl": _FROM_ABOVE,
    "a bowl on a plate, with an egg": _FROM_ABOVE,
    "a bottle that looks out of a basket": _FROM_ABOVE,
    "one orange on another in a basket": (0.45, -0.25, 1.20),
    "a tomato in a bin": (0.40, -0.25, 1.60),
    "a ball in the bathtub": _FROM_ABOVE,
    "keys in a drawer": _FROM_ABOVE,
    "a lamp that hangs over a table": (0.80, -0.50, 0.30),
    "a picture on a wall": (0.80, -0.60, 0.20),
    "a shelf on a wall, with a book": (0.80, -0.60, 0.35),
    "a cabinet at a wall": (0.80, -0.60, 0.30),
    "a picture on the floor, leaning on a wall": (0.60, -0.80, 0.25),
    "in the corner of a room": (0.30, -0.45, 1.00),
    "where two rooms meet, more in one": (0.45, -0.15, 1.00),
    "through a wall, in the flat only": (0.45, -0.15, 1.00),
    "of no known size": (0.80, -0.50, 0.42),
}
"""From where a situation is looked at, if not from the front: its direction."""
_NOWHERE: Colour = (0.85, 0.20, 0.55)
_WORDS = {
    "isOn": "on", "isInside": "inside", "isLocatedIn": "in", "isAttachedTo": "attached to",
    "isUnder": "under", "isAbove": "above", "isNextTo": "next to", "isBetween": "between",
    "touches": "touches",
}  # fmt: skip


def tile(number: int, situation: Situation, lines: int) -> Image.Image:
    """One situation, drawn, with its title and what is said of it, in so many lines."""
    told = sentences(situation)
    made = Image.new("RGB", (_WIDTH, _HEIGHT + (lines + 1) * _LINE + 16), _PAPER)
    made.paste(view_of(situation), (0, 0))
    draw = ImageDraw.Draw(made)
    draw.text((10, _HEIGHT + 7), f"{number}  {situation.title}", fill=_INK, font=ImageFont.load_default(15))
    for row, sentence in enumerate(told):
        at = (10, _HEIGHT + 10 + (row + 1) * _LINE)
        draw.text(at, sentence, fill=_QUIET, font=ImageFont.load_default(14))
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
        around = np.clip(max(max(s.size) for s in close), *_ROUND_ABOUT) * np.array([1.0, 1.0, 0.6])
        low = np.maximum(low, np.min([(*s.bounds[:2], s.bottom) for s in close], axis=0) - offset - around)
        high = np.minimum(high, np.max([(*s.bounds[2:], s.top) for s in close], axis=0) - offset + around)
    back = _SEEN_FROM.get(situation.title, FROM_THE_FRONT)
    view = overview(low, high, _FINE * _WIDTH, _FINE * _HEIGHT, back)
    rgb, depth, _ = raycast(compiled, data, view)
    rgb[depth == 0.0] = _PAPER
    made = Image.fromarray(rgb).resize((_WIDTH, _HEIGHT), Image.Resampling.BOX)
    _name(made, view, [(s.name, np.subtract(_top_of(s), (ox, oy, 0.0))) for s in solids])
    return made


def _top_of(solid: Solid) -> tuple[float, float, float]:
    """Where the name of a thing is written: above its middle; of a place, in a corner of its floor."""
    if solid.is_place:
        return solid.to_map((0.3 * solid.size[0], -0.3 * solid.size[1], 0.0))
    return (*solid.centre[:2], solid.top)


def _name(made: Image.Image, view: View, named: list[tuple[str, Floats]]) -> None:
    """Write the names into a picture, each near what it is of, none over another or beyond the edge."""
    draw, font = ImageDraw.Draw(made), ImageFont.load_default(13)
    to_camera = np.linalg.inv(view.map_from_camera)
    taken: list[tuple[float, float, float, float]] = []
    for name, point in named:
        u, v, w = view.intrinsics @ (to_camera @ (*point, 1.0))[:3]
        x0, y0, x1, y1 = draw.textbbox((0, 0), name, font=font)
        wide, high = x1 - x0, y1 - y0
        x = float(np.clip(u / w / _FINE - wide / 2, 6, made.width - wide - 6))
        y = float(np.clip(v / w / _FINE - high - 8, 6, made.height - high - 6))
        while any(x < b and a < x + wide and y < d and c < y + high for a, c, b, d in taken):
            y += 3.0
        taken.append((x - 4, y - 3, x + wide + 4, y + high + 3))
        draw.rounded_rectangle((x - 4, y - 3, x + wide + 4, y + high + 4), 4, fill=_LABEL)
        draw.text((x - x0, y - y0), name, fill=_INK, font=font)


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
    rows: list[list[Image.Image]] = []
    numbered = list(enumerate(SITUATIONS, start=1))
    for first in range(0, len(numbered), _COLUMNS):
        row = numbered[first : first + _COLUMNS]
        lines = max(len(sentences(situation)) for _, situation in row)
        rows.append([tile(number, situation, lines) for number, situation in row])
    made = Image.new("RGB", (_COLUMNS * _WIDTH, sum(row[0].height for row in rows)), _PAPER)
    top = 0
    for tiles in rows:
        for column, one in enumerate(tiles):
            made.paste(one, (column * _WIDTH, top))
        top += tiles[0].height
    return made


def main() -> None:
    """Write the picture to the file named on the command line."""
    sheet().quantize(128).save(Path(sys.argv[1]), optimize=True)


if __name__ == "__main__":
    main()
