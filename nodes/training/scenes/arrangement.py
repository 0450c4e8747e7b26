"""Arrangement of objects in training scenes: loose, crowded, touching."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.sim_node.models.parts import Vec3
from semmap.nodes.sim_node.vision.view import View, look_at
from semmap.nodes.training.scenes.foreign_things import ForeignThing
from semmap.nodes.training.scenes.placements import Rectangle, spread
from semmap.nodes.training.scenes.sampling import LARGE, SMALL, own_things, small_things, varied_colour
from semmap.nodes.training.scenes.simulated_scenes import Item

_HEAPED = 0.8
_DISTANCES_M = (0.8, 2.2)
_USUAL = 0.6  # of the tables are about as high as tables are, and desks as desks

CARRIERS = ("table", "table", "desk", "counter", "cabinet")
"""The furniture that objects are placed on; tables are more frequent."""


def table_scene(
    things: Sequence[Item], rng: np.random.Generator, *, crowded_share: float = 0.5
) -> list[Item]:
    """Return a table with these things on it; things without room are left out."""
    area = (float(rng.uniform(0.7, 1.0)), float(rng.uniform(1.0, 1.5)))
    kind = str(rng.choice(CARRIERS))
    height = float(rng.uniform(0.5, 0.9))
    if rng.random() < _USUAL:
        height = MODELS[kind].size_m[2] * math.exp(rng.normal(0.0, 0.05))
    sizes = [thing.size_m for thing in things]
    crowded = rng.random() < crowded_share
    gap = float(rng.uniform(0.001, 0.02)) if crowded else float(rng.uniform(0.03, 0.08))
    table = Item("table", kind, (*area, height), varied_colour(kind, rng), (0.0, 0.0, 0.0), 0.0)
    return [table, *standing(things, spread(sizes, area, gap, rng, crowded=crowded), height)]


def floor_scene(things: Sequence[Item], rng: np.random.Generator) -> list[Item]:
    """Place things on the floor."""
    sizes = [thing.size_m for thing in things]
    return standing(things, spread(sizes, (3.5, 3.5), float(rng.uniform(0.02, 0.3)), rng), 0.0)


def standing(things: Sequence[Item], placements: Sequence[Rectangle | None], height_m: float) -> list[Item]:
    """Return things at their placements and one height, with unique names."""
    return [
        replace(
            thing,
            name=f"{thing.kind}_{n}",
            position_m=(placement[0], placement[1], height_m + 0.001),
            yaw_rad=placement[4],
        )
        for n, (thing, placement) in enumerate(zip(things, placements, strict=True))
        if placement is not None
    ]


def views(
    target_m: Vec3, distance_m: tuple[float, float], rng: np.random.Generator, *, count: int = 2
) -> list[View]:
    """Return cameras that look at about the same spot from different sides."""
    first, found = rng.uniform(-math.pi, math.pi), []
    for n in range(count):
        azimuth = first + n * rng.uniform(0.9, 2.4)
        elevation, distance = rng.uniform(0.45, 1.1), rng.uniform(*distance_m)
        back = np.array(
            [
                math.cos(azimuth) * math.cos(elevation),
                math.sin(azimuth) * math.cos(elevation),
                math.sin(elevation),
            ]
        )
        target = np.array(target_m) + rng.normal(0.0, 0.05, 3)
        found.append(look_at(target + distance * back, target, 640, 480, float(rng.uniform(0.78, 1.05))))
    return found


Scene = tuple[list[Item], list[View]]
"""Things, and the cameras."""


def training_scenes(count: int, foreign: Sequence[ForeignThing], rng: np.random.Generator) -> Iterator[Scene]:
    """Yield scenes in which all things are about equally frequent: small ones on tables, all on floors."""
    small, large = small_things(foreign, rng), own_things(LARGE, rng)
    for number in range(count):
        if number % 5 < 4:
            items = table_scene([small() for _ in range(rng.integers(8, 19))], rng)
            yield items, views((0.0, 0.0, items[0].size_m[2]), _DISTANCES_M, rng)
        else:
            things = [next(large) for _ in range(4)] + [small() for _ in range(3)]
            yield floor_scene(things, rng), views((0.0, 0.0, 0.3), (2.0, 4.0), rng)


def own_scenes(count: int, rng: np.random.Generator) -> Iterator[Scene]:
    """Yield tables with our unmodified models only, mostly crowded, as in a simulated map."""
    things = own_things(SMALL, rng, own_colours=1.0)
    for _ in range(count):
        items = table_scene([next(things) for _ in range(rng.integers(8, 19))], rng, crowded_share=_HEAPED)
        yield items, views((0.0, 0.0, items[0].size_m[2]), _DISTANCES_M, rng)


def heaps(count: int, foreign: Sequence[ForeignThing], rng: np.random.Generator) -> Iterator[Scene]:
    """Yield scenes of close things, often several of a kind, which are hard to segment."""
    small = small_things(foreign, rng)
    for _ in range(count):
        few = [small() for _ in range(rng.integers(3, 12))]
        things = [few[int(n)] for n in rng.integers(len(few), size=rng.integers(6, 14))]
        items = table_scene(things, rng, crowded_share=_HEAPED)
        yield items, views((0.0, 0.0, items[0].size_m[2]), _DISTANCES_M, rng)
