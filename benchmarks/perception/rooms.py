"""Rooms for evaluation, generated with other sizes, colours, poses and cameras than in training."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.sim_node.models.parts import Colour, Vec3
from semmap.nodes.sim_node.vision.view import View, look_at
from semmap.nodes.training.scenes.simulated_scenes import Item

THIN_M = 0.025
"""Lower things are hidden by sensor noise and counted separately [m]."""

_THINGS = (
    "can bottle wine_bottle jar carton cereals cup bowl glass pitcher pot vase kettle toaster apple banana"
    " bread cheese corn lemon onion orange pear potato tomato yogurt ball box basket bin book bucket candle"
    " case flower flower_pot hat radio phone camera iron coffee_machine speaker laptop shoes towel"
    " toilet_paper soap backpack bag folder lamp hammer microwave"
)
THINGS = tuple(_THINGS.split())
"""The models on tables in these rooms, all higher than `THIN_M`."""

_SUPPORTS = {"table": 0.75, "desk": 0.75, "counter": 0.9}


@dataclass(frozen=True)
class Room:
    """A table with the things on it, and two cameras."""

    items: tuple[Item, ...]
    views: tuple[View, ...]
    floor: Colour


def rooms(count: int, seed: int, *, crowded: bool, things: Sequence[str] = THINGS) -> Iterator[Room]:
    """Yield random rooms: a table with six to twelve things, apart or crowded and touching."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        yield _room(rng, crowded=crowded, things=things)


def low_rooms(count: int, seed: int, height_m: float, *, things: Sequence[str] = THINGS) -> Iterator[Room]:
    """Yield random rooms with things apart on a table of a height, the same at each height."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        yield _room(rng, crowded=False, things=things, height_m=height_m)


def _room(
    rng: np.random.Generator, *, crowded: bool, things: Sequence[str], height_m: float | None = None
) -> Room:
    support = "table" if height_m else str(rng.choice(list(_SUPPORTS)))
    top = (float(rng.uniform(0.8, 0.95)), float(rng.uniform(1.3, 1.6)), height_m or _SUPPORTS[support])
    furniture = Item("support", support, top, _colour(support, rng), (0.0, 0.0, 0.0), 0.0)
    kinds = [str(kind) for kind in rng.choice(things, int(rng.integers(6, 13)))]
    sizes = [_size(kind, rng) for kind in kinds]
    place = _heap if crowded else _rows
    items = [furniture]
    for n, (kind, size, spot) in enumerate(zip(kinds, sizes, place(sizes, top, rng), strict=True)):
        if spot is not None:
            x, y, yaw = spot
            items.append(Item(f"thing{n}", kind, size, _colour(kind, rng), (x, y, top[2] + 0.001), yaw))
    return Room(tuple(items), _cameras(top, rng), _any_colour(rng))


def _size(kind: str, rng: np.random.Generator) -> Vec3:
    whole = rng.uniform(0.88, 1.12)
    x, y, z = (float(own * whole * rng.uniform(0.95, 1.05)) for own in MODELS[kind].size_m)
    return (x, y, z)


def _colour(kind: str, rng: np.random.Generator) -> Colour:
    red, green, blue = (float(np.clip(c + rng.uniform(-0.1, 0.1), 0.0, 1.0)) for c in MODELS[kind].colour)
    return (red, green, blue)


def _any_colour(rng: np.random.Generator) -> Colour:
    red, green, blue = rng.uniform(0.3, 0.8, 3).tolist()
    return (red, green, blue)


Spot = tuple[float, float, float]
"""Centre x and y [m], yaw [rad]."""


def _rows(sizes: Sequence[Vec3], top_m: Vec3, rng: np.random.Generator) -> list[Spot | None]:
    """Place things in rows from one edge of the table, at least 4 cm apart."""
    spots: list[Spot | None] = []
    x, y, deep = -top_m[0] / 2 + 0.03, -top_m[1] / 2 + 0.03, 0.0
    for size in sizes:
        yaw = float(rng.uniform(-math.pi, math.pi))
        reach = math.hypot(size[0], size[1])
        if y + reach > top_m[1] / 2 - 0.03:
            x, y, deep = x + deep + 0.04, -top_m[1] / 2 + 0.03, 0.0
        if x + reach > top_m[0] / 2:
            spots.append(None)
            continue
        spots.append((x + reach / 2, y + reach / 2, yaw))
        y, deep = y + reach + float(rng.uniform(0.04, 0.15)), max(deep, reach)
    return spots


def _heap(sizes: Sequence[Vec3], top_m: Vec3, rng: np.random.Generator) -> list[Spot | None]:
    """Place things side by side on a grid; each touches the previous one, and rows nearly touch."""
    turn, spots = float(rng.uniform(-0.4, 0.4)), []
    x, y, deep = 0.0, 0.0, 0.0
    line = float(rng.uniform(0.45, 0.8))
    for size in sizes:
        quarter = int(rng.integers(4))
        across, along = (size[0], size[1]) if quarter % 2 == 0 else (size[1], size[0])
        if y + along > line:
            x, y, deep = x + deep + float(rng.uniform(0.002, 0.02)), 0.0, 0.0
        spots.append((x + across / 2, y + along / 2, quarter * math.pi / 2))
        y, deep = y + along + 0.0005, max(deep, across)
    middle = (x + deep) / 2, line / 2
    c, s = math.cos(turn), math.sin(turn)
    placed: list[Spot | None] = []
    for u, v, yaw in spots:
        at = (c * (u - middle[0]) - s * (v - middle[1]), s * (u - middle[0]) + c * (v - middle[1]))
        fits = abs(at[0]) < top_m[0] / 2 - 0.1 and abs(at[1]) < top_m[1] / 2 - 0.1
        placed.append((*at, yaw + turn) if fits else None)
    return placed


def _cameras(top_m: Vec3, rng: np.random.Generator) -> tuple[View, View]:
    """Return two Kinects on stands, 60 to 130 degrees apart, looking down at the table."""
    first, apart = rng.uniform(-math.pi, math.pi), math.radians(rng.uniform(60.0, 130.0))
    found = []
    for azimuth in (first, first + apart):
        away, above = rng.uniform(0.9, 1.3), rng.uniform(0.7, 1.1)
        eye = np.array([away * math.cos(azimuth), away * math.sin(azimuth), top_m[2] + above])
        found.append(look_at(eye, np.array([0.0, 0.0, top_m[2] + 0.05]), 640, 480, math.radians(48.0)))
    return found[0], found[1]
