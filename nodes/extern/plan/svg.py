"""The plan as an SVG document at a scale, on an A4 sheet."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Final
from xml.sax.saxutils import escape, quoteattr

from semmap.nodes.extern.plan.floor import Area, Floor, Piece
from semmap.nodes.extern.plan.labels import Box, Label, Sheet, box_of, text_width_mm
from semmap.nodes.geometry.polygons import Point, Polygon

_SHEETS_MM: Final = ((297.0, 210.0), (210.0, 297.0))
_MARGIN_MM: Final = 10.0
_PIXELS_IN_MM: Final = 96.0 / 25.4
"""CSS pixels."""
_HEAD_MM, _FOOT_MM, _RULER_MM = 10.0, 9.0, 5.0
_LEGEND_MM: Final = 52.0
"""The width of the list of objects whose names do not fit on the plan."""
_SCALES: Final = (
    10,
    20,
    25,
    50,
    75,
    100,
    150,
    200,
    250,
    500,
    750,
    1000,
    1500,
    2000,
    2500,
    5000,
    10_000,
    20_000,
)
_BARS_M: Final = (0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
_WALL_M: Final = 0.1
_ROOM_TEXT_MM, _NAME_MM, _SMALL_MM, _NUMBER_MM = 3.4, 2.1, 1.9, 1.7
_NAMED_FROM_MM: Final = 0.5
"""The minimum size of an object on paper for a label."""
_MOST_LABELS: Final = 1500

_STYLE: Final = """
text{font-family:Helvetica,Arial,'DejaVu Sans',sans-serif;fill:#1d2430}
.floor{fill:#fdfcfa;stroke:#5a6270;stroke-width:.15}
.wall{fill:#5a6270;stroke:#5a6270;stroke-linejoin:miter}
.zone{fill:none;stroke:#8a93a3;stroke-width:.2;stroke-dasharray:1.2 .8}
.furniture{fill:#e8e1d3;stroke:#6d6455;stroke-width:.2}
.small{fill:#fff;stroke:#6d6455;stroke-width:.15}
.person{fill:#cfe3f5;stroke:#2d5f8b;stroke-width:.25}
.edge{stroke-width:.4}.inside{stroke-width:.06}
.furniture.inside{stroke:#e8e1d3}.small.inside{stroke:#fff}.person.inside{stroke:#cfe3f5}
.overhead{fill:none;stroke:#6d6455;stroke-width:.18;stroke-dasharray:.7 .5}
.gap{fill:#fdfcfa;stroke:#5a6270;stroke-width:.15}
.leaf{fill:#b98d5a;stroke:#7a5a34;stroke-width:.15}
.open{fill:none;stroke:#7a5a34;stroke-width:.2;stroke-dasharray:.6 .5}
.pane{fill:#d8ecf7;stroke:#4a7690;stroke-width:.15}
.leader{stroke:#7d8696;stroke-width:.12}
.name{fill:#1d2430}.halo{stroke:#fff;stroke-width:.5;paint-order:stroke;stroke-linejoin:round}
.room{font-weight:bold;fill:#39424f}.soft{fill:#5a6270}
.rule{stroke:#5a6270;stroke-width:.2}.grid{stroke:#5a6270;stroke-width:.15}
.bar{fill:#1d2430}.rest{fill:#fff;stroke:#1d2430;stroke-width:.2}
"""


def drawing(floor: Floor, *, title: str, commit: int, stamp_ns: int) -> str:
    """Return the plan of `floor` as an SVG document; see `draw`."""
    return draw(floor, title=title, commit=commit, stamp_ns=stamp_ns).svg


def draw(floor: Floor, *, title: str, commit: int, stamp_ns: int) -> Drawing:
    """Draw the plan of `floor` on an A4 sheet, at the largest standard scale that fits.

    The heading is `title` with the commit and its time [ns since 1970; 0 for unknown]. Objects whose names do
    not fit on the plan are numbered and listed.
    """
    sheet = _sheet_for(floor)
    lines = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{sheet.wide:g}mm" height="{sheet.high:g}mm" '
        f'viewBox="0 0 {sheet.wide:g} {sheet.high:g}" role="img" aria-label={quoteattr(_plain(title))}>',
        f"<title>{escape(_plain(title))}</title>",
        f"<style>{_STYLE}</style>",
        f'<rect width="{sheet.wide:g}" height="{sheet.high:g}" fill="#fff"/>',
        *_head(sheet, title, commit, stamp_ns),
        *_ruler(sheet),
        *_shapes(sheet, floor),
        *_names(sheet, floor),
        *_foot(sheet, floor),
        "</svg>",
        "",
    )
    return Drawing("\n".join(lines), sheet)


@dataclass(frozen=True)
class Drawing:
    """An SVG document with its transformation between map and image."""

    svg: str
    _sheet: _Paper

    @property
    def wide_mm(self) -> float:
        """The width of the sheet."""
        return self._sheet.wide

    @property
    def high_mm(self) -> float:
        """The height of the sheet."""
        return self._sheet.high

    def pixel(self, point: Point) -> tuple[float, float]:
        """Return the position of a point of the map [m] in the image [CSS pixel, y down]."""
        x, y = self._sheet.at(point)
        return (x * _PIXELS_IN_MM, y * _PIXELS_IN_MM)

    def point(self, x: float, y: float) -> Point:
        """Return the point of the map [m] at a position in the image [CSS pixel]."""
        return self._sheet.point((x / _PIXELS_IN_MM, y / _PIXELS_IN_MM))


@dataclass(frozen=True)
class _Paper:
    """A sheet with the scale and the bounds of the map; its coordinates are mm from the upper left corner."""

    wide: float
    high: float
    scale: int
    bounds: tuple[float, float, float, float]

    @property
    def mm(self) -> float:
        """Millimetres on paper per metre of the map."""
        return 1000.0 / self.scale

    @property
    def frame(self) -> Box:
        """The area of the map."""
        x0, x1, y0, y1 = self.bounds
        left, top = _MARGIN_MM + _RULER_MM, _MARGIN_MM + _HEAD_MM
        return Box(left, top, left + (x1 - x0) * self.mm, top + (y1 - y0) * self.mm)

    @property
    def legend(self) -> Box:
        """The area of the list of names: to the right of the map, or below it."""
        frame = self.frame
        bottom = self.high - _MARGIN_MM - _FOOT_MM
        beside = self.wide - _MARGIN_MM - frame.x1 - 4.0
        if beside >= _LEGEND_MM - 4.0:
            return Box(frame.x1 + 4.0, frame.y0, self.wide - _MARGIN_MM, bottom)
        return Box(frame.x0, frame.y1 + _RULER_MM + 4.0, self.wide - _MARGIN_MM, bottom)

    def at(self, point: Point) -> tuple[float, float]:
        x0, _, _, y1 = self.bounds
        frame = self.frame
        return (frame.x0 + (point[0] - x0) * self.mm, frame.y0 + (y1 - point[1]) * self.mm)

    def point(self, at: tuple[float, float]) -> Point:
        x0, _, _, y1 = self.bounds
        frame = self.frame
        return (x0 + (at[0] - frame.x0) / self.mm, y1 - (at[1] - frame.y0) / self.mm)

    def box(self, outline: Polygon) -> Box:
        return box_of(map(self.at, outline))


def _sheet_for(floor: Floor) -> _Paper:
    x0, x1, y0, y1 = floor.bounds
    bounds = (x0 - _WALL_M, x1 + _WALL_M, y0 - _WALL_M, y1 + _WALL_M)
    wide_m, high_m = bounds[1] - bounds[0], bounds[3] - bounds[2]
    for scale in (*_SCALES, _SCALES[-1] * 10):
        for wide, high in _SHEETS_MM:
            room_x = wide - 2 * _MARGIN_MM - _RULER_MM
            room_y = high - 2 * _MARGIN_MM - _HEAD_MM - _FOOT_MM - _RULER_MM
            need_x, need_y = wide_m * 1000.0 / scale, high_m * 1000.0 / scale
            has_legend = room_x - need_x >= _LEGEND_MM or room_y - need_y >= _LEGEND_MM
            if need_x <= room_x and need_y <= room_y and has_legend:
                return _Paper(wide, high, scale, bounds)
    scale = math.ceil(1000.0 * max(wide_m / 200.0, high_m / 150.0))
    return _Paper(*_SHEETS_MM[0], scale, bounds)


def _head(sheet: _Paper, title: str, commit: int, stamp_ns: int) -> Iterator[str]:
    when = f", {datetime.fromtimestamp(stamp_ns / 1e9):%Y-%m-%d %H:%M:%S}" if stamp_ns else ""
    yield _text(_MARGIN_MM, _MARGIN_MM + 4.0, title, 4.6, "room")
    right = sheet.wide - _MARGIN_MM
    yield _text(right, _MARGIN_MM + 3.6, f"commit {commit}{when}", 2.8, "soft", anchor="end")


def _ruler(sheet: _Paper) -> Iterator[str]:
    """Draw the axes of the map frame with their scales [m]."""
    frame = sheet.frame
    x0, x1, y0, y1 = sheet.bounds
    step = next((bar for bar in _BARS_M if bar * sheet.mm >= 11.0), _BARS_M[-1])
    yield f'<path class="grid" d="M{frame.x0:.2f} {frame.y0:.2f}V{frame.y1:.2f}H{frame.x1:.2f}" fill="none"/>'
    for n in range(math.ceil(x0 / step), math.floor(x1 / step) + 1):
        x, _ = sheet.at((n * step, y0))
        yield f'<path class="grid" d="M{x:.2f} {frame.y1:.2f}v1"/>'
        yield _text(x, frame.y1 + 3.4, f"{n * step:g}", 2.0, "soft", anchor="middle")
    for n in range(math.ceil(y0 / step), math.floor(y1 / step) + 1):
        _, y = sheet.at((x0, n * step))
        yield f'<path class="grid" d="M{frame.x0:.2f} {y:.2f}h-1"/>'
        yield _text(frame.x0 - 1.6, y + 0.7, f"{n * step:g}", 2.0, "soft", anchor="end")
    yield _text(frame.x1 + 0.8, frame.y1 + 0.7, "x [m]", 2.0, "soft")
    yield _text(frame.x0, frame.y0 - 0.9, "y [m]", 2.0, "soft", anchor="middle")


def _shapes(sheet: _Paper, floor: Floor) -> Iterator[str]:
    """Draw all shapes. Walls are the area around and between the floors."""
    for room in floor.rooms:
        yield _polygon(sheet, room.outline, "wall", stroke_mm=2.0 * _WALL_M * sheet.mm)
    for room in floor.rooms:
        yield _polygon(sheet, room.outline, "floor")
    for zone in floor.zones:
        yield _polygon(sheet, zone.outline, "zone")
    for piece in floor.pieces:
        if piece.kind in ("door", "window"):
            yield from _opening(sheet, piece)
    for piece in floor.pieces:
        if piece.kind not in ("door", "window"):
            yield from _piece(sheet, piece)


def _piece(sheet: _Paper, piece: Piece) -> Iterator[str]:
    """Draw the outline of an object: the edges of all its parts, and above them their insides."""
    parts = () if piece.kind == "overhead" else piece.parts
    if len(parts) < 2:
        yield _polygon(sheet, piece.outline, piece.kind, of=piece.name)
        return
    for layer in ("edge", "inside"):
        for part in parts:
            yield _polygon(sheet, part, f"{piece.kind} {layer}", of=piece.name)


def _opening(sheet: _Paper, piece: Piece) -> Iterator[str]:
    """Draw a gap in the wall with a door or a window."""
    yield _polygon(sheet, _as_thick_as_the_wall(piece.outline), "gap")
    kind = "pane" if piece.kind == "window" else "open" if piece.is_open else "leaf"
    yield _polygon(sheet, piece.outline, kind, of=piece.name)


def _as_thick_as_the_wall(outline: Polygon) -> Polygon:
    """Extend a rectangle across its long sides to the thickness of the wall."""
    if len(outline) != 4:
        return outline
    a, b, c, d = outline
    if math.dist(a, b) > math.dist(b, c):
        a, b, c, d = b, c, d, a  # a to b is across the wall
    thick = math.dist(a, b)
    if not 0.0 < thick < _WALL_M:
        return outline
    grow = (_WALL_M / thick - 1.0) / 2.0
    dx, dy = (b[0] - a[0]) * grow, (b[1] - a[1]) * grow
    return ((a[0] - dx, a[1] - dy), (b[0] + dx, b[1] + dy), (c[0] + dx, c[1] + dy), (d[0] - dx, d[1] - dy))


def _names(sheet: _Paper, floor: Floor) -> Iterator[str]:
    """Draw the names of rooms, then of objects, the largest first. Names that do not fit are listed."""
    boxes = {piece.name: sheet.box(piece.outline) for piece in floor.pieces}
    labels = Sheet(sheet.frame, tuple(boxes.values()), _walls(sheet, floor.rooms))
    for room in floor.rooms:
        yield from _room_name(sheet, labels, room)
    listed: list[tuple[int, str]] = []
    marked = [p for p in floor.pieces if p.kind not in ("door", "window")]
    marked.sort(key=lambda p: (p.kind == "small", -_extent(boxes[p.name]), p.name))
    unnamed = max(0, len(marked) - _MOST_LABELS)
    for piece in marked[:_MOST_LABELS]:
        box, size = boxes[piece.name], _SMALL_MM if piece.kind == "small" else _NAME_MM
        label = labels.place(piece.name, size, box) if _extent(box) >= _NAMED_FROM_MM else None
        if label is not None:
            yield from _label(label, size)
            continue
        number = len(listed) + 1
        mark = labels.place(str(number), _NUMBER_MM, box, most_cost=12.0)
        if mark is None:
            unnamed += 1
            continue
        listed.append((number, piece.name))
        yield from _label(mark, _NUMBER_MM)
    yield from _legend(sheet, listed, unnamed)


def _extent(box: Box) -> float:
    return max(box.x1 - box.x0, box.y1 - box.y0)


def _walls(sheet: _Paper, rooms: Sequence[Area]) -> tuple[Box, ...]:
    """Return the walls that are parallel to the axes, which names should not cross."""
    thick, sides = _WALL_M * sheet.mm, []
    for room in rooms:
        for a, b in zip(room.outline, (*room.outline[1:], room.outline[0]), strict=True):
            side = sheet.box((a, b))
            if min(side.x1 - side.x0, side.y1 - side.y0) < 0.5:
                sides.append(Box(side.x0 - thick, side.y0 - thick, side.x1 + thick, side.y1 + thick))
    return tuple(sides)


def _room_name(sheet: _Paper, labels: Sheet, room: Area) -> Iterator[str]:
    for size in (_ROOM_TEXT_MM, _NAME_MM):
        label = labels.place_in(_plain(room.label), size, 2.2 * size, sheet.box(room.outline))
        if label is None:
            continue
        x, _ = label.box.middle
        yield _text(x, label.box.y0 + 0.9 * size, room.label, size, "room halo", anchor="middle")
        floor = f"{room.floor_m2:.1f} m²"
        yield _text(x, label.box.y0 + 1.95 * size, floor, 0.72 * size, "soft halo", anchor="middle")
        return


def _label(label: Label, size_mm: float) -> Iterator[str]:
    x, y = label.box.middle
    if label.leader is not None:
        x2, y2 = label.leader
        x1, y1 = min(max(x2, label.box.x0), label.box.x1), min(max(y2, label.box.y0), label.box.y1)
        yield f'<line class="leader" x1="{x1:.2f}" y1="{y1:.2f}" x2="{x2:.2f}" y2="{y2:.2f}"/>'
    turn = f' transform="rotate(-90 {x:.2f} {y:.2f})"' if label.upright else ""
    yield _text(x, y + 0.36 * size_mm, label.text, size_mm, "name halo", anchor="middle", more=turn)


def _legend(sheet: _Paper, listed: Sequence[tuple[int, str]], unnamed: int) -> Iterator[str]:
    box, row = sheet.legend, 1.5 * _SMALL_MM
    rows = max(1, int((box.y1 - box.y0) / row) - 1)
    wide = max((text_width_mm(f"{n} {name}", _SMALL_MM) for n, name in listed), default=0.0) + 3.0
    wide = min(max(wide, 15.0), box.x1 - box.x0)
    shown = rows * max(1, int((box.x1 - box.x0) / wide))
    for i, (number, name) in enumerate(listed[:shown]):
        x, y = box.x0 + wide * (i // rows), box.y0 + row * (i % rows + 1)
        yield _text(x + 3.6, y, str(number), _SMALL_MM, "soft", anchor="end")
        yield _text(x + 4.6, y, name, _SMALL_MM, "name")
    if (more := unnamed + max(0, len(listed) - shown)) > 0:
        what = "object" if more == 1 else "objects"
        yield _text(box.x0, box.y1, f"{more} more {what}", _SMALL_MM, "soft")


def _foot(sheet: _Paper, floor: Floor) -> Iterator[str]:
    """Draw the scale, as a bar and as a number, and the number of entities that are not drawn."""
    y = sheet.high - _MARGIN_MM
    bar = next((b for b in reversed(_BARS_M) if b * sheet.mm <= 45.0), _BARS_M[0])
    long = bar * sheet.mm
    yield f'<rect class="bar" x="{_MARGIN_MM}" y="{y - 1.6:.2f}" width="{long / 2:.3f}" height="1.4"/>'
    yield (
        f'<rect class="rest" x="{_MARGIN_MM + long / 2:.3f}" y="{y - 1.6:.2f}" width="{long / 2:.3f}" '
        'height="1.4"/>'
    )
    yield _text(_MARGIN_MM, y - 2.4, "0", 2.2, "soft")
    yield _text(_MARGIN_MM + long, y - 2.4, f"{bar:g} m", 2.2, "soft", anchor="middle")
    yield _text(_MARGIN_MM + long + 8.0, y, f"1 : {sheet.scale}", 3.2, "name")
    if floor.unplaced:
        what = "object" if floor.unplaced == 1 else "objects"
        note = f"{floor.unplaced} {what} without position or size"
        yield _text(sheet.wide - _MARGIN_MM, y, note, 2.2, "soft", anchor="end")


def _polygon(sheet: _Paper, outline: Polygon, kind: str, *, of: str = "", stroke_mm: float = 0.0) -> str:
    points = " ".join(f"{x:.2f},{y:.2f}" for x, y in map(sheet.at, outline))
    stroke = f' stroke-width="{stroke_mm:.2f}"' if stroke_mm else ""
    shape = f'<polygon class="{kind}" points="{points}"{stroke}'
    return f"{shape}><title>{escape(_plain(of))}</title></polygon>" if of else f"{shape}/>"


def _text(
    x: float, y: float, text: str, size_mm: float, kind: str, *, anchor: str = "start", more: str = ""
) -> str:
    at = f'x="{x:.2f}" y="{y:.2f}" font-size="{size_mm:g}" text-anchor="{anchor}"'
    return f'<text class="{kind}" {at}{more}>{escape(_plain(text))}</text>'


def _plain(text: str) -> str:
    """Replace the control characters, which XML does not permit, by spaces."""
    return "".join(letter if letter.isprintable() else " " for letter in text)
