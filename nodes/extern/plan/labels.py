"""Placement of labels on a sheet without overlap: rectangles in millimetres, y down."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from typing import Final, NamedTuple

_EM_MM: Final = 0.6
"""The width of a letter divided by the font size, for wide fonts."""
_OFFSETS_MM: Final = (0.6, 2.0, 4.0, 7.0)
"""The possible distances of a label from its object."""
_GAP_MM: Final = 0.5
"""The minimum distance of two labels: closer ones look like one text."""


class Box(NamedTuple):
    """A rectangle on the sheet [mm]; `y0` is its upper edge."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def middle(self) -> tuple[float, float]:
        """The centre [mm]."""
        return ((self.x0 + self.x1) / 2.0, (self.y0 + self.y1) / 2.0)

    def holds(self, other: Box) -> bool:
        """Return whether it contains all of `other`."""
        return self.x0 <= other.x0 and self.y0 <= other.y0 and self.x1 >= other.x1 and self.y1 >= other.y1

    def overlap_mm2(self, other: Box) -> float:
        """Return the area of the intersection."""
        wide = min(self.x1, other.x1) - max(self.x0, other.x0)
        high = min(self.y1, other.y1) - max(self.y0, other.y0)
        return wide * high if wide > 0.0 and high > 0.0 else 0.0


class Label(NamedTuple):
    """A text in its box; `upright` is rotated by 90°, `leader` is the end point of a leader line."""

    text: str
    box: Box
    upright: bool = False
    leader: tuple[float, float] | None = None


def text_width_mm(text: str, size_mm: float) -> float:
    """Return the maximum width of a text in a sans-serif font."""
    return sum(_ems(letter) for letter in text) * size_mm


def _ems(letter: str) -> float:
    if unicodedata.combining(letter):
        return 0.0
    return 1.05 if unicodedata.east_asian_width(letter) in "WF" else _EM_MM


class _Boxes:
    """Boxes in a grid of squares, for fast lookup of neighbours."""

    _SIDE_MM: Final = 12.0

    def __init__(self, boxes: Iterable[Box] = ()) -> None:
        self._by_square: dict[tuple[int, int], list[Box]] = {}
        for box in boxes:
            self.add(box)

    def add(self, box: Box) -> None:
        for square in self._squares(box):
            self._by_square.setdefault(square, []).append(box)

    def near(self, box: Box) -> set[Box]:
        """Return the boxes that may overlap `box`, without duplicates."""
        return {other for square in self._squares(box) for other in self._by_square.get(square, ())}

    def _squares(self, box: Box) -> Iterator[tuple[int, int]]:
        side = self._SIDE_MM
        for i in range(int(box.x0 // side), int(box.x1 // side) + 1):
            for j in range(int(box.y0 // side), int(box.y1 // side) + 1):
                yield i, j


class Sheet:
    """A sheet on which labels are placed one after another."""

    def __init__(self, within: Box, things: Sequence[Box], walls: Sequence[Box] = ()) -> None:
        """Labels stay `within`, apart from one another.

        Covering `things` has a cost, and covering `walls` a higher one.
        """
        self._within = within
        self._things = _Boxes(things)
        self._walls = _Boxes(walls)
        self._taken = _Boxes()

    def place(self, text: str, size_mm: float, thing: Box, *, most_cost: float = 6.0) -> Label | None:
        """Place the name of an object in it or next to it; return None if there is no space."""
        wide, high = text_width_mm(text, size_mm), 1.15 * size_mm
        for candidate in _inside(text, wide, high, thing):
            if self._is_free(candidate.box) and self._covers(candidate.box, thing) < 0.3 * wide * high:
                return self._take(candidate)
        best, least = None, most_cost
        for far, candidate in _beside(text, wide, high, thing):
            if not self._is_free(candidate.box):
                continue
            covered = self._covers(candidate.box, thing) + 1.5 * _shared(self._walls, candidate.box)
            cost = far + 5.0 * covered / (wide * high)
            if cost < least:
                best, least = candidate, cost
        return None if best is None else self._take(best)

    def place_in(self, text: str, size_mm: float, high_mm: float, room: Box) -> Label | None:
        """Place the name of a room where it covers least of its contents, or return None."""
        wide = text_width_mm(text, size_mm)
        free_x, free_y = room.x1 - room.x0 - wide, room.y1 - room.y0 - high_mm
        if free_x < 0.0 or free_y < 0.0:
            return None
        shares = [i / 12.0 for i in range(13)]
        boxes = [
            Box(x, y, x + wide, y + high_mm)
            for x, y in ((room.x0 + i * free_x, room.y0 + j * free_y) for i in shares for j in shares)
        ]
        free = [box for box in boxes if self._is_free(box)]
        if not free:
            return None
        x, y = room.middle

        def cost(box: Box) -> float:
            away = abs(box.middle[0] - x) + abs(box.middle[1] - y)
            return 3.0 * self._covers(box) + away

        return self._take(Label(text, min(free, key=cost)))

    def _take(self, label: Label) -> Label:
        box = label.box
        self._taken.add(Box(box.x0 - _GAP_MM, box.y0 - _GAP_MM, box.x1 + _GAP_MM, box.y1 + _GAP_MM))
        return label

    def _is_free(self, box: Box) -> bool:
        return self._within.holds(box) and not _shared(self._taken, box)

    def _covers(self, box: Box, own: Box | None = None) -> float:
        """Return the area of other objects under a label [mm^2], without the support of its own object."""
        return sum(
            box.overlap_mm2(thing) for thing in self._things.near(box) if own is None or not thing.holds(own)
        )


def _shared(boxes: _Boxes, box: Box) -> float:
    return sum(box.overlap_mm2(other) for other in boxes.near(box))


def _inside(text: str, wide: float, high: float, thing: Box) -> Iterator[Label]:
    x, y = thing.middle
    lying = Box(x - wide / 2.0, y - high / 2.0, x + wide / 2.0, y + high / 2.0)
    if thing.holds(lying):
        yield Label(text, lying)
    standing = Box(x - high / 2.0, y - wide / 2.0, x + high / 2.0, y + wide / 2.0)
    if thing.holds(standing):
        yield Label(text, standing, upright=True)


def _beside(text: str, wide: float, high: float, thing: Box) -> Iterator[tuple[float, Label]]:
    """Yield positions around an object with their distances; distant ones have a leader line."""
    x, y = thing.middle
    for far in _OFFSETS_MM:
        left, right = thing.x0 - far - wide, thing.x1 + far
        above, below = thing.y0 - far - high, thing.y1 + far
        corners = (
            (x - wide / 2.0, below), (x - wide / 2.0, above), (right, y - high / 2.0), (left, y - high / 2.0),
            (right, below), (left, below), (right, above), (left, above),
        )  # fmt: skip
        leader = (x, y) if far > _OFFSETS_MM[0] else None
        for x0, y0 in corners:
            yield far, Label(text, Box(x0, y0, x0 + wide, y0 + high), leader=leader)


def box_of(points: Iterable[tuple[float, float]]) -> Box:
    """Return the bounding box of points, of which there must be at least one."""
    xs, ys = zip(*points, strict=True)
    return Box(min(xs), min(ys), max(xs), max(ys))
