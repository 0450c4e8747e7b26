"""Simulated scenes, cut up and described: what recognition learns from."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, fields, replace
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from nodes.perception_node.sights import see
from nodes.training import pairs as pairing
from nodes.training import samples as sampling
from nodes.training.arranging import training_scenes
from nodes.training.pairs import Pairs
from nodes.training.samples import Samples
from nodes.training.scenes import Stage

HELD_OUT = 5
"""Of so many scenes one is kept apart: no classifier learns from it."""

_PARTS = 10  # that scenes are made in: the same whatever the machine


@dataclass(frozen=True)
class Gathered:
    """What recognition learns from: things, and pairs of neighbours in the scenes that are held out."""

    things: Samples
    pairs: Pairs


def gather(scenes: int, seed: int) -> Gathered:
    """Samples from so many simulated scenes, made by several processes."""
    each = -(-scenes // _PARTS)
    with ProcessPoolExecutor(min(_PARTS, os.cpu_count() or 1), get_context("spawn")) as pool:
        return joined(list(pool.map(_gather, [each] * _PARTS, range(seed, seed + _PARTS))), each)


def joined(parts: Sequence[Gathered], each: int) -> Gathered:
    """All of all parts, of so many scenes each."""
    things = [replace(part.things, scene=part.things.scene + n * each) for n, part in enumerate(parts)]
    return Gathered(sampling.joined(things), pairing.joined([part.pairs for part in parts]))


def _gather(scenes: int, seed: int) -> Gathered:
    stage, rng = Stage(), np.random.default_rng(seed)
    things, pairs = list[Samples](), list[Pairs]()
    for number, (items, views) in enumerate(training_scenes(scenes, rng)):
        bodies = stage.show(items)
        red, green, blue = rng.uniform(0.2, 0.9, 3).tolist()
        stage.paint({"floor": (red, green, blue)}, light=float(rng.uniform(0.25, 0.45)))
        shot = stage.shoot(bodies, views, rng)
        found = [see(cloud) for cloud in shot.clouds]
        samples = sampling.samples_of(shot, found, items, number)
        if samples is not None:
            things.append(samples)
        if number % HELD_OUT == 0:
            pairs += pairing.pairs_of(shot, found, items)
    return Gathered(sampling.joined(things), pairing.joined(pairs))


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
