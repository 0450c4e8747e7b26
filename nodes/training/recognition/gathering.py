"""Simulated scenes, cut up and described: what recognition learns from."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, fields, replace
from itertools import count, repeat
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from nodes.training.recognition.neighbour_pairs import Pairs, pairs_of
from nodes.training.recognition.samples import Samples, samples_of
from nodes.training.scenes.arranging import Scene, heaps, training_scenes
from nodes.training.scenes.foreign_things import ForeignThing, foreign_things
from nodes.training.scenes.simulated_scenes import Item, Shot, Stage

_SCENES, _HEAPS = 150, 40  # a part, at most
_COLOURLESS = 0.06  # of the scenes are seen without colours
_SEEDS = 10  # from the first of scenes to the first of heaps


@dataclass(frozen=True)
class Gathered:
    """What recognition learns from: things, and pairs of neighbours in other scenes."""

    things: Samples
    pairs: Pairs


def gather(scenes: int, heaped: int, seed: int, foreign: Path | None = None) -> Gathered:
    """Things from so many simulated scenes, pairs from so many heaps, made by several processes.

    They are made in parts, each by a process of its own: the same whatever the machine. `foreign`: a folder
    of foreign things that come among ours.
    """
    with ProcessPoolExecutor(os.cpu_count(), get_context("spawn"), max_tasks_per_child=1) as pool:
        things = list(pool.map(_things, _shares(scenes, _SCENES), count(seed), repeat(foreign)))
        pairs = list(pool.map(_pairs, _shares(heaped, _HEAPS), count(seed + _SEEDS), repeat(foreign)))
    return joined(things, pairs)


def joined(things: Sequence[Samples], pairs: Sequence[Pairs]) -> Gathered:
    """All of all parts."""
    numbered = [replace(part, scene=part.scene + n * _SCENES) for n, part in enumerate(things)]
    return Gathered(Samples.joined(numbered), Pairs.joined(pairs))


def _shares(total: int, most: int) -> list[int]:
    return [min(most, total - done) for done in range(0, total, most)]


def _things(scenes: int, seed: int, foreign: Path | None) -> Samples:
    rng = np.random.default_rng(seed)
    shots = _photographed(training_scenes(scenes, _learnable(foreign), rng), rng)
    samples = (samples_of(shot, items, number) for number, (shot, items) in enumerate(shots))
    return Samples.joined([found for found in samples if found is not None])


def _pairs(heaped: int, seed: int, foreign: Path | None) -> Pairs:
    rng = np.random.default_rng(seed)
    shots = _photographed(heaps(heaped, _learnable(foreign), rng), rng)
    return Pairs.joined([pairs for shot, items in shots for pairs in pairs_of(shot, items, rng)])


def _learnable(foreign: Path | None) -> list[ForeignThing]:
    return [thing for thing in (foreign_things(foreign) if foreign else []) if thing.learnable]


def _photographed(scenes: Iterable[Scene], rng: np.random.Generator) -> Iterator[tuple[Shot, list[Item]]]:
    stage = Stage()
    for items, views in scenes:
        bodies = stage.show(items)
        red, green, blue = rng.uniform(0.2, 0.9, 3).tolist()
        stage.paint({"floor": (red, green, blue)}, light=float(rng.uniform(0.25, 0.45)))
        paints = {item.name: item.paint for item in items if item.paint is not None}
        shot = stage.shoot(bodies, views, rng, paints)
        if rng.random() < _COLOURLESS:
            shot = replace(shot, clouds=tuple(replace(cloud, colors=None) for cloud in shot.clouds))
        yield shot, items


def write(gathered: Gathered, path: Path) -> None:
    """Keep it in a file."""
    things = {f.name: getattr(gathered.things, f.name) for f in fields(Samples)}
    np.savez(path, **things, **{f"pairs.{f.name}": getattr(gathered.pairs, f.name) for f in fields(Pairs)})


def read(path: Path) -> Gathered:
    """Take it out of a file again."""
    with np.load(path) as arrays:
        return Gathered(
            Samples(**{f.name: arrays[f.name] for f in fields(Samples)}),
            Pairs(**{f.name: arrays[f"pairs.{f.name}"] for f in fields(Pairs)}),
        )
