"""Simulated scenes, cut up and described: what recognition learns from."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, fields, replace
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from nodes.training import pairs as pairing
from nodes.training import samples as sampling
from nodes.training.arranging import Scene, heaps, training_scenes
from nodes.training.pairs import Pairs
from nodes.training.samples import Samples
from nodes.training.scenes import Item, Shot, Stage

_SCENES, _HEAPS = 150, 40  # a part
_SEEDS = 10  # from the first of scenes to the first of heaps


@dataclass(frozen=True)
class Gathered:
    """What recognition learns from: things, and pairs of neighbours in other scenes."""

    things: Samples
    pairs: Pairs


def gather(scenes: int, heaped: int, seed: int) -> Gathered:
    """Things from so many simulated scenes, pairs from so many heaps, made by several processes.

    They are made in parts, each by a process of its own: the same whatever the machine.
    """
    with ProcessPoolExecutor(os.cpu_count(), get_context("spawn"), max_tasks_per_child=1) as pool:
        things = list(pool.map(_things, range(seed, seed - (-scenes // _SCENES))))
        pairs = list(pool.map(_pairs, range(seed + _SEEDS, seed + _SEEDS - (-heaped // _HEAPS))))
    return joined(things, pairs)


def joined(things: Sequence[Samples], pairs: Sequence[Pairs]) -> Gathered:
    """All of all parts."""
    numbered = [replace(part, scene=part.scene + n * _SCENES) for n, part in enumerate(things)]
    return Gathered(sampling.joined(numbered), pairing.joined(pairs))


def _things(seed: int) -> Samples:
    rng = np.random.default_rng(seed)
    shots = _photographed(training_scenes(_SCENES, rng), rng)
    samples = (sampling.samples_of(shot, items, number) for number, (shot, items) in enumerate(shots))
    return sampling.joined([found for found in samples if found is not None])


def _pairs(seed: int) -> Pairs:
    rng = np.random.default_rng(seed)
    shots = _photographed(heaps(_HEAPS, rng), rng)
    return pairing.joined([pairs for shot, items in shots for pairs in pairing.pairs_of(shot, items, rng)])


def _photographed(scenes: Iterable[Scene], rng: np.random.Generator) -> Iterator[tuple[Shot, list[Item]]]:
    stage = Stage()
    for items, views in scenes:
        bodies = stage.show(items)
        red, green, blue = rng.uniform(0.2, 0.9, 3).tolist()
        stage.paint({"floor": (red, green, blue)}, light=float(rng.uniform(0.25, 0.45)))
        yield stage.shoot(bodies, views, rng), items


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
