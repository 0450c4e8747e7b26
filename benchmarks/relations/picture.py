"""The situations as one image: `python -m benchmarks.relations.picture docs/relations.png`."""

from __future__ import annotations

import sys
from pathlib import Path

import mujoco
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from benchmarks.relations.situations import SITUATIONS, Said, Situation
from semmap.nodes.kb_node.relations.geometry.solids import Solid, solid_of
from semmap.nodes.sim_node.models.forms import column, hollow_box, ring, shifted
from semmap.nodes.sim_node.models.library import build
from semmap.nodes.sim_node.models.parts import Colour, Part, Role, Shape, ball, box
from semmap.nodes.sim_node.physics.build import add_part
from semmap.nodes.sim_node.vision.raycast import raycast
from semmap.nodes.sim_node.vision.view import FROM_THE_FRONT, View, overview
from semmap.ontology.model_shapes import shapes
from semmap.schemas.entities import Entity
from semmap.schemas.relations import RELATIONS

_WIDTH, _HEIGHT, _LINE, _COLUMNS, _FINE = 320, 232, 18, 6, 2
_PAPER, _INK, _QUIET, _RULE = (250, 250, 248), (24, 24, 28), (70, 70, 78), (205, 205, 200)
_LABEL = (255, 255, 236)
_SMALL = ImageFont.load_default(12)
Rectangle = tuple[float, float, float, float]
_FLOOR: Colour = (0.86, 0.85, 0.82)
_PLACES: tuple[Colour, ...] = ((0.78, 0.84, 0.90), (0.90, 0.84, 0.74), (0.78, 0.88, 0.78))
_BOXES: tuple[Colour, ...] = ((0.72, 0.55, 0.36), (0.45, 0.58, 0.66), (0.62, 0.66, 0.42))
_ROUND_ABOUT = (0.06, 0.13)
"""The minimum and maximum visible surroundings of small things [m]."""
_OF_A_ROOM_M = 0.9
"""The visible part of a room around the things in it."""
_FROM_THE_SIDE, _FROM_ABOVE = (0.90, -0.42, 0.16), (0.55, -0.30, 0.90)
_SEEN_FROM = {
    "let go two centimetres above it": (0.90, -0.42, -0.03),
    "sunk a centimetre into it": (0.90, -0.42, 0.03),
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
    "close by, on another thing": (0.85, 0.50, 0.40),
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
"""The viewing directions of situations that are not shown from the front."""
_LOOKED_AT_CLOSELY = {
    "beside it, at its height",
    "nearly all of it over the edge",
    "a large one on a small one",
}
_NOWHERE: Colour = (0.85, 0.20, 0.55)
_WORDS: dict[str, str] = {row.name: row.phrase.removeprefix("is ") for row in RELATIONS}


def tile(number: int, situation: Situation, lines: int) -> Image.Image:
    """Draw one situation with its title and its relations, in so many lines."""
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
    """Return the relations as short text."""
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
    """Draw the things; containers with content are cut open in front."""
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
    if any(entity.place for entity in entities):
        things = [solid for solid in solids if not solid.is_place]
        low[:2] = np.maximum(low[:2], np.min([s.bounds[:2] for s in things], axis=0) - _OF_A_ROOM_M)
        high[:2] = np.minimum(high[:2], np.max([s.bounds[2:] for s in things], axis=0) + _OF_A_ROOM_M)
    back = _SEEN_FROM.get(situation.title, FROM_THE_FRONT)
    view = overview(low, high, _FINE * _WIDTH, _FINE * _HEIGHT, back)
    rgb, depth, _ = raycast(compiled, data, view)
    rgb[depth == 0.0] = _PAPER
    made = Image.fromarray(rgb).resize((_WIDTH, _HEIGHT), Image.Resampling.BOX)
    named = _named(situation)
    outlines = [_outline(s, view, (ox, oy, 0.0)) for s in solids if not s.is_place]
    around = dict(zip((s.name for s in solids if not s.is_place), outlines, strict=True))
    _name_places(made, [(s.name, _outline(s, view, (ox, oy, 0.0))) for s in solids if s.is_place])
    _name_things(made, {name: around[name] for name in named}, outlines)
    return made


def _named(situation: Situation) -> list[str]:
    """Return the things whose names are shown: those that differ only in their numbers."""
    names = [entity.name for entity in situation.things if not entity.place]
    kinds = [name.rstrip("0123456789") for name in names]
    return [name for name, kind in zip(names, kinds, strict=True) if kinds.count(kind) > 1]


def _outline(solid: Solid, view: View, origin: tuple[float, float, float]) -> Rectangle:
    """Return its bounding box in the image [pixel]: left, top, right, bottom."""
    x, y, z = solid.size
    heights = (0.0,) if solid.is_place else (0.0, z)
    corners = [solid.to_map((u * x, v * y, w)) for u in (-0.5, 0.5) for v in (-0.5, 0.5) for w in heights]
    there = np.linalg.inv(view.map_from_camera) @ np.c_[np.subtract(corners, origin), np.ones(len(corners))].T
    u, v, w = view.intrinsics @ there[:3]
    return (min(u / w) / _FINE, min(v / w) / _FINE, max(u / w) / _FINE, max(v / w) / _FINE)


def _name_things(made: Image.Image, named: dict[str, Rectangle], others: list[Rectangle]) -> None:
    """Write names above, beside or below their things, where they cover least."""
    hidden = [one for one in others if (one[2] - one[0]) * (one[3] - one[1]) < 0.4 * _WIDTH * _HEIGHT]
    for name, (x0, y0, x1, y1) in named.items():
        wide, high = _extent(name)
        middle, level = (x0 + x1 - wide) / 2, (y0 + y1 - high) / 2
        spots = ((middle, y0 - high - 3), (x1 + 4, level), (x0 - wide - 4, level), (middle, y1 + 3))
        inside = [(np.clip(x, 4, _WIDTH - wide - 4), np.clip(y, 4, _HEIGHT - high - 6)) for x, y in spots]
        rectangles = [(float(x), float(y), float(x) + wide, float(y) + high) for x, y in inside]
        best = min(rectangles, key=lambda spot: sum(_shared(spot, other) for other in hidden))
        hidden.append(best)
        _write(made, name, best)


def _name_places(made: Image.Image, named: list[tuple[str, Rectangle]]) -> None:
    """Write the names of places in a column, with the colours of their floors."""
    for row, ((name, _), colour) in enumerate(zip(named, _PLACES, strict=False)):
        wide, high = _extent(name)
        top = 8.0 + row * (high + 9)
        ImageDraw.Draw(made).rectangle((8, top, 8 + high, top + high), fill=_as_bytes(colour), outline=_INK)
        _write(made, name, (high + 16.0, top, high + 16.0 + wide, top + high))


def _as_bytes(colour: Colour) -> tuple[int, int, int]:
    red, green, blue = (round(255 * value) for value in colour[:3])
    return red, green, blue


def _extent(name: str) -> tuple[float, float]:
    x0, y0, x1, y1 = _SMALL.getbbox(name)
    return float(x1 - x0), float(y1 - y0)


def _write(made: Image.Image, name: str, where: Rectangle) -> None:
    draw = ImageDraw.Draw(made)
    draw.rounded_rectangle((where[0] - 3, where[1] - 2, where[2] + 3, where[3] + 3), 3, fill=_LABEL)
    x0, y0, _, _ = _SMALL.getbbox(name)
    draw.text((where[0] - x0, where[1] - y0), name, fill=_INK, font=_SMALL)


def _shared(one: Rectangle, other: Rectangle) -> float:
    """Return the intersection area of two rectangles."""
    wide, high = min(one[2], other[2]) - max(one[0], other[0]), min(one[3], other[3]) - max(one[1], other[1])
    return max(0.0, wide) * max(0.0, high)


def _close(situation: Situation, solids: list[Solid]) -> list[Solid]:
    """Return the thing in focus, if all relations are about it being on or inside something larger."""
    relations = {relation for _, relation, _ in (*situation.said, *situation.also)}
    small = [solid for solid in solids if max(solid.size) < 0.5 * max(max(s.size) for s in solids)]
    carried = {name for name, _, _ in situation.said}
    if situation.title in _LOOKED_AT_CLOSELY:
        return small
    if relations & {"isUnder", "isAbove", "isLocatedIn", "isAttachedTo"} or not small:
        return []
    return small if {solid.name for solid in small} <= carried else []


def _height(solid: Solid) -> float:
    return 0.01 if solid.is_place else solid.top


def _parts(entity: Entity, solid: Solid, opened: set[str], colour: Colour) -> list[Part]:
    x, y, _ = solid.size
    if entity.place:  # the smaller one over the larger
        return [box((x - 0.04, y - 0.04, 0.02), (0.0, 0.0, -0.015 - 1e-4 * x * y), colour)]
    if not solid.is_measured:
        return [ball((0.08, 0.08, 0.08), (0.0, 0.0, 0.04), _NOWHERE)]
    if not entity.model:
        return [box(solid.size, (0.0, 0.0, solid.size[2] / 2), colour)]
    built = build(entity.model, entity.size_m).parts
    parts = [part for part in built if part.role is not Role.COLLISION]
    interiors = shapes()[entity.model].interiors
    if entity.name in opened and (vessel := next((part for part in built if part.cavity), None)):
        return _cut_vessel(vessel, parts)
    if entity.name in opened and interiors and not any(inner.open for inner in interiors):
        return _cut_open(entity)
    return [part for part in parts if entity.name not in opened or not _fills(part, entity.model)]


def _fills(part: Part, model: str) -> bool:
    """Return whether a part fills most of an interior and hides its content, like water in a bathtub."""
    for inner in shapes()[model].interiors:
        low, high = np.array(inner.low), np.array(inner.high)
        middle, reach = np.array(part.centre), part.reach()
        if np.all((low < middle) & (middle < high)) and np.all(reach[:2] > 0.3 * (high - low)[:2]):
            return True
    return False


def _cut_vessel(body: Part, parts: list[Part]) -> list[Part]:
    """Return the floor and back of a solid body with a cavity, and the parts beside and behind it."""
    (cx, cy, cz), (rx, ry, rz) = body.centre, (float(reach) for reach in body.reach())
    wall, floor_m = 0.05 * min(rx, ry), 2.0 * rz * (body.cavity.floor if body.cavity else 0.0)
    if body.shape is Shape.BOX:
        walls = hollow_box(2 * rx, 2 * ry, 2 * rz - floor_m, wall, body.colour)
    else:
        walls = [
            column(rx, 0.0, wall, body.colour),
            *ring((rx, rx), 0.0, 2 * rz - floor_m, wall, body.colour),
        ]
    back = [part for part in walls if part.centre[0] <= 0.0]
    beside = [part for part in parts if abs(part.centre[1] - cy) > ry or part.centre[0] < cx - rx]
    return [*shifted(back, x=cx, y=cy, z=cz - rz + floor_m), *beside]


def _cut_open(entity: Entity) -> list[Part]:
    """Return the walls and boards of a closed thing without its front."""
    parts = build(entity.model, entity.size_m).parts
    colliding = [part for part in parts if part.role is not Role.VISUAL]
    x = max(float(part.centre[0] + part.reach()[0]) for part in colliding)
    behind = [
        part for part in colliding if part.centre[0] + part.reach()[0] < x - 0.03 or part.reach()[0] > 0.05
    ]
    seen = [part.colour for part in parts if part.role is not Role.COLLISION]
    return [Part(p.shape, p.half, p.centre, seen[0] if seen else p.colour, p.turn) for p in behind]


def sheet() -> Image.Image:
    """Draw all situations in rows."""
    rows: list[list[Image.Image]] = []
    numbered = list(enumerate(SITUATIONS, start=1))
    for first in range(0, len(numbered), _COLUMNS):
        row = numbered[first : first + _COLUMNS]
        lines = max(len(sentences(situation)) for _, situation in row)
        rows.append([tile(number, situation, lines) for number, situation in row])
    made = Image.new("RGB", (_COLUMNS * _WIDTH, sum(row[0].height for row in rows)), _PAPER)
    top = 0
    for tiles in rows:
        for k, one in enumerate(tiles):
            made.paste(one, (k * _WIDTH, top))
        top += tiles[0].height
    return made


def main() -> None:
    """Write the image to the file named on the command line."""
    sheet().save(Path(sys.argv[1]), optimize=True)


if __name__ == "__main__":
    main()
