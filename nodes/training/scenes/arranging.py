"""Where things stand in a scene for training: loose, crowded, touching."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from nodes.sim_node.models.model_table import MODELS
from nodes.sim_node.models.parts import Colour, Vec3
from nodes.sim_node.vision.view import View, look_at
from nodes.training.scenes.placements import Rectangle, spread
from nodes.training.scenes.simulated_scenes import Item

_HANGING = (
    "air_conditioning blinds board boiler curtain door extractor_hood fences handle heating jacket_hook light"
    " mirror picture poster power_plug shelf shower stairs switch tap thermostat wall window clock"
    " washing_line rug"
)
HANGING = frozenset(_HANGING.split())
"""Models that are part of a room, or hang on its walls: no objects that stand somewhere."""

SMALL_M = 0.5
_ODD = 0.6
_ODD_SHARE = 0.08
_HEAPED = 0.8
_USUAL = 0.6  # of the tables are about as high as tables are, and desks as desks
SMALL = tuple(k for k, kind in MODELS.items() if max(kind.size_m) <= SMALL_M and k not in HANGING)
LARGE = tuple(k for k, kind in MODELS.items() if max(kind.size_m) > SMALL_M and k not in HANGING)

CARRIERS = ("table", "table", "desk", "counter", "cabinet")
"""What things stand on, tables more often than others."""


def varied_size(kind: str, rng: np.random.Generator) -> Vec3:
    """The model's own size, somewhat larger or smaller, slimmer or stouter; now and then quite another."""
    if kind in SMALL and rng.random() < _ODD_SHARE:
        factor = float(rng.choice([rng.uniform(0.4, 0.55), rng.uniform(1.9, 3.0)]))
        x, y, z = MODELS[kind].size_m * np.exp(np.log(factor) + rng.normal(0.0, 0.2, 3))
        return (float(x), float(y), float(z))
    x, y, z = MODELS[kind].size_m * np.exp(rng.normal(0.0, 0.08) + rng.normal(0.0, 0.05, 3))
    return (float(x), float(y), float(z))


def varied_colour(kind: str, rng: np.random.Generator) -> Colour:
    """The model's own colour under other light; now and then another one."""
    base = np.array(MODELS[kind].colour)
    strange = rng.random() < 0.1
    red, green, blue = rng.uniform(0.05, 0.95, 3) if strange else base + rng.normal(0.0, 0.05, 3)
    return (float(np.clip(red, 0, 1)), float(np.clip(green, 0, 1)), float(np.clip(blue, 0, 1)))


def table_scene(kinds: Sequence[str], rng: np.random.Generator, *, crowded_share: float = 0.5) -> list[Item]:
    """A table and these things on it; those that find no room are left out."""
    area = (float(rng.uniform(0.7, 1.0)), float(rng.uniform(1.0, 1.5)))
    kind = str(rng.choice(CARRIERS))
    height = float(rng.uniform(0.5, 0.9))
    if rng.random() < _USUAL:
        height = MODELS[kind].size_m[2] * math.exp(rng.normal(0.0, 0.05))
    sizes = [varied_size(kind, rng) for kind in kinds]
    crowded = rng.random() < crowded_share
    gap = float(rng.uniform(0.001, 0.02)) if crowded else float(rng.uniform(0.03, 0.08))
    table = Item("table", kind, (*area, height), varied_colour(kind, rng), (0.0, 0.0, 0.0), 0.0)
    return [
        table,
        *standing(kinds, sizes, spread(kinds, sizes, area, gap, rng, crowded=crowded), height, rng),
    ]


def floor_scene(kinds: Sequence[str], rng: np.random.Generator) -> list[Item]:
    """These things on the floor."""
    sizes = [varied_size(kind, rng) for kind in kinds]
    placements = spread(kinds, sizes, (3.5, 3.5), float(rng.uniform(0.02, 0.3)), rng)
    return standing(kinds, sizes, placements, 0.0, rng)


def standing(
    kinds: Sequence[str],
    sizes: Sequence[Vec3],
    placements: Sequence[Rectangle | None],
    height_m: float,
    rng: np.random.Generator,
) -> list[Item]:
    """Things at their placements, at one height."""
    items = []
    for n, (kind, size, placement) in enumerate(zip(kinds, sizes, placements, strict=True)):
        if placement is not None:
            at = (placement[0], placement[1], height_m + 0.001)
            odd = kind in SMALL and is_odd(kind, size)
            items.append(Item(f"{kind}_{n}", kind, size, varied_colour(kind, rng), at, placement[4], odd))
    return items


def is_odd(kind: str, size_m: Vec3) -> bool:
    """Whether this size is far from what such things measure."""
    return bool(np.abs(np.log(np.array(size_m) / MODELS[kind].size_m)).max() > _ODD)


def views(
    target_m: Vec3, distance_m: tuple[float, float], rng: np.random.Generator, *, count: int = 2
) -> list[View]:
    """Cameras that look at about the same spot from different sides."""
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


def training_scenes(count: int, rng: np.random.Generator) -> Iterator[Scene]:
    """Scenes in which every model comes about equally often: small things on tables, all things on floors."""
    small, large = _deck(SMALL, rng), _deck(LARGE, rng)
    for number in range(count):
        if number % 5 < 4:
            items = table_scene([next(small) for _ in range(rng.integers(8, 19))], rng)
            yield items, views((0.0, 0.0, items[0].size_m[2]), (0.9, 1.8), rng)
        else:
            kinds = [next(large) for _ in range(4)] + [next(small) for _ in range(3)]
            yield floor_scene(kinds, rng), views((0.0, 0.0, 0.3), (2.0, 4.0), rng)


def heaps(count: int, rng: np.random.Generator) -> Iterator[Scene]:
    """Scenes of things close together, often several of a kind: whose piece is whose is hard to tell."""
    small = _deck(SMALL, rng)
    for _ in range(count):
        few = [next(small) for _ in range(rng.integers(3, 12))]
        kinds = [str(kind) for kind in rng.choice(few, rng.integers(6, 14))]
        items = table_scene(kinds, rng, crowded_share=_HEAPED)
        yield items, views((0.0, 0.0, items[0].size_m[2]), (0.9, 1.8), rng)


def _deck(kinds: Sequence[str], rng: np.random.Generator) -> Iterator[str]:
    """All of them in random order, again and again."""
    while True:
        yield from (str(kind) for kind in rng.permutation(kinds))
