"""Generation of the training data of recognition from simulated scenes."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from itertools import count, repeat
from multiprocessing import get_context
from pathlib import Path
from typing import TypeVar

import numpy as np

from semmap.nodes.training.recognition.neighbour_pairs import Pairs, pairs_of
from semmap.nodes.training.recognition.samples import Samples, samples_of
from semmap.nodes.training.scenes.arrangement import Scene, heaps, own_scenes, training_scenes
from semmap.nodes.training.scenes.foreign_things import ForeignThing, foreign_things
from semmap.nodes.training.scenes.simulated_scenes import Item, Shot, Stage

_SCENES, _HEAPS = 150, 40  # a part, at most
_COLOURLESS = 0.06  # of the scenes are seen without colours
_SEEDS = 100  # from the first of scenes to the first of heaps, and from there to the first of own scenes


_Part = TypeVar("_Part", Samples, Pairs)


@dataclass(frozen=True)
class Gathered:
    """The training data: things, our unmodified models, and neighbour pairs in other scenes."""

    things: Samples
    own: Samples
    pairs: Pairs


def gather(
    scenes: int,
    heaped: int,
    ours: int,
    seed: int,
    foreign: Path | None = None,
    keep: Path | None = None,
) -> Gathered:
    """Things from so many scenes, pairs from so many heaps, and so many scenes of ours, by several processes.

    They are made in parts, each by a process of its own: the same whatever the machine. `foreign`: a folder
    of foreign things that come among ours. `keep`: a folder in which parts are kept; those that are there
    are not made again.
    """
    with ProcessPoolExecutor(os.cpu_count(), get_context("spawn"), max_tasks_per_child=1) as pool:
        things = list(pool.map(_things, _shares(scenes, _SCENES), count(seed), repeat(foreign), repeat(keep)))
        pairs = list(
            pool.map(_pairs, _shares(heaped, _HEAPS), count(seed + _SEEDS), repeat(foreign), repeat(keep))
        )
        own = list(pool.map(_own, _shares(ours, _SCENES), count(seed + 2 * _SEEDS), repeat(keep)))
    return joined(things, own, pairs)


def read(folder: Path) -> Gathered:
    """Read all parts in a folder."""
    return joined(
        _things_in(folder),
        _things_in(folder, "own"),
        [Pairs.read(part) for part in sorted(folder.glob(_file("pairs", "*", "*")), key=_in_order)],
    )


def read_things(folder: Path) -> Samples:
    """Read the things of all parts in a folder."""
    return _numbered(_things_in(folder))


def joined(things: Sequence[Samples], own: Sequence[Samples], pairs: Sequence[Pairs]) -> Gathered:
    """Join all parts."""
    return Gathered(_numbered(things), _numbered(own), Pairs.joined(pairs))


def _things_in(folder: Path, name: str = "things") -> list[Samples]:
    return [Samples.read(part) for part in sorted(folder.glob(_file(name, "*", "*")), key=_in_order)]


def _numbered(things: Sequence[Samples]) -> Samples:
    """Join all parts, with unique scene numbers."""
    return Samples.joined([replace(part, scene=part.scene + n * _SCENES) for n, part in enumerate(things)])


def _shares(total: int, most: int) -> list[int]:
    return [min(most, total - done) for done in range(0, total, most)]


def _things(scenes: int, seed: int, foreign: Path | None, keep: Path | None) -> Samples:
    return _kept(Samples, "things", lambda: _seen_in(scenes, seed, foreign), scenes, seed, keep)


def _own(scenes: int, seed: int, keep: Path | None) -> Samples:
    return _kept(Samples, "own", lambda: _own_in(scenes, seed), scenes, seed, keep)


def _pairs(heaped: int, seed: int, foreign: Path | None, keep: Path | None) -> Pairs:
    return _kept(Pairs, "pairs", lambda: _neighbours_in(heaped, seed, foreign), heaped, seed, keep)


def _kept(
    kind: type[_Part], name: str, make: Callable[[], _Part], size: int, seed: int, keep: Path | None
) -> _Part:
    """Read a part from a folder, or generate and store it."""
    if keep is None:
        return make()
    path = keep / _file(name, seed, size)
    if not path.exists():
        keep.mkdir(parents=True, exist_ok=True)
        make().write(path)
    return kind.read(path)


def _file(name: str, seed: int | str, size: int | str) -> str:
    return f"{name}-{seed}-of-{size}.npz"


def _in_order(path: Path) -> int:
    return int(path.name.split("-")[1])


def _seen_in(scenes: int, seed: int, foreign: Path | None) -> Samples:
    rng = np.random.default_rng(seed)
    return _sampled(training_scenes(scenes, _learnable(foreign), rng), rng)


def _own_in(scenes: int, seed: int) -> Samples:
    rng = np.random.default_rng(seed)
    return _sampled(own_scenes(scenes, rng), rng)


def _sampled(scenes: Iterable[Scene], rng: np.random.Generator) -> Samples:
    shots = photographed(scenes, rng)
    samples = (samples_of(shot, items, number) for number, (shot, items) in enumerate(shots))
    return Samples.joined([found for found in samples if found is not None])


def _neighbours_in(heaped: int, seed: int, foreign: Path | None) -> Pairs:
    rng = np.random.default_rng(seed)
    shots = photographed(heaps(heaped, _learnable(foreign), rng), rng)
    return Pairs.joined([pairs for shot, items in shots for pairs in pairs_of(shot, items, rng)])


def _learnable(foreign: Path | None) -> list[ForeignThing]:
    return [thing for thing in (foreign_things(foreign) if foreign else []) if thing.learnable]


def photographed(scenes: Iterable[Scene], rng: np.random.Generator) -> Iterator[tuple[Shot, list[Item]]]:
    """Yield the images of scenes, with floors and light that vary."""
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
