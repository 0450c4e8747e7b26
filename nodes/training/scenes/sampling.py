"""Random sampling of a scene's objects: our models, varieties, families, foreign things and distractors."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.sim_node.models.parts import Colour, Parts, Vec3
from semmap.nodes.training.scenes.distractors import distractor_parts, size_of
from semmap.nodes.training.scenes.families.table import FAMILIES, drawn
from semmap.nodes.training.scenes.foreign_things import ForeignThing, parts_of, texture_of
from semmap.nodes.training.scenes.paint import Paint, any_paint
from semmap.nodes.training.scenes.simulated_scenes import DISTRACTOR, Item, foreign_label
from semmap.nodes.training.scenes.varieties import VARIETIES, Form, any_size, is_like_another

_HANGING = (
    "air_conditioning blinds board boiler curtain door extractor_hood fences handle heating jacket_hook light"
    " mirror picture poster power_plug shelf shower stairs switch tap thermostat wall window clock"
    " washing_line rug"
)
HANGING = frozenset(_HANGING.split())
"""Models that are part of a room or hang on its walls, and are not free-standing."""

SMALL_M = 0.5
SMALL = tuple(k for k, kind in MODELS.items() if max(kind.size_m) <= SMALL_M and k not in HANGING)
LARGE = tuple(k for k, kind in MODELS.items() if max(kind.size_m) > SMALL_M and k not in HANGING)

_SHARES = (0.44, 0.13, 0.18, 0.11, 0.14)
"""The shares of small things: our models, varieties, families, foreign things, distractors."""
_FOREIGN = 3
_OWN_COLOURS, _COLOURS_OF_A_MODEL, _OWN_TEXTURE = 0.5, 0.25, 0.5
"""The shares of our models, varieties and foreign things that keep their own colours."""

_COLOURED = (
    "apple banana bread carrot cheese corn egg lemon onion orange pear potato tomato toilet_paper fruit@Fruit"
)
COLOURED = tuple(_COLOURED.split())
"""Kinds with a natural colour."""

_TRUE_COLOURS = dict.fromkeys(COLOURED, 0.75)
"""The shares of these that keep their own colours."""

_RIPE = {
    "apple": (
        (0.75, 0.12, 0.10),
        (0.55, 0.10, 0.12),
        (0.50, 0.66, 0.18),
        (0.82, 0.76, 0.24),
        (0.78, 0.38, 0.18),
    ),
    "pear": ((0.68, 0.72, 0.24), (0.48, 0.60, 0.18), (0.84, 0.76, 0.30), (0.56, 0.42, 0.20)),
    "onion": ((0.72, 0.48, 0.22), (0.50, 0.12, 0.28), (0.88, 0.84, 0.76)),
    "fruit@Fruit": (
        (0.75, 0.10, 0.12),
        (0.35, 0.12, 0.25),
        (0.22, 0.14, 0.26),
        (0.90, 0.58, 0.32),
        (0.45, 0.34, 0.16),
        (0.55, 0.66, 0.20),
    ),
    "potato": ((0.72, 0.58, 0.36), (0.60, 0.28, 0.26)),
}
"""Kinds with several natural colours."""

_FOREIGN_LARGER, _FOREIGN_STOUTER = 0.2, 0.06
"""The exponents x of the maximum random scale e^x of foreign things, overall and per axis."""

DrawItem = Callable[[], Item]
"""Returns the next object, without a placement."""


def small_things(foreign: Sequence[ForeignThing], rng: np.random.Generator) -> DrawItem:
    """Return a sampler of small things of all sorts; things of one sort are about equally frequent."""
    shares = np.array(_SHARES)
    if not foreign:
        shares[_FOREIGN] = 0.0
    of_sort = [
        own_things(SMALL, rng),
        _varieties(rng),
        _families(rng),
        _foreign(foreign, rng),
        _distractors(rng),
    ]
    return lambda: next(of_sort[int(rng.choice(len(of_sort), p=shares / shares.sum()))])


def own_things(
    kinds: Sequence[str], rng: np.random.Generator, *, own_colours: float | None = None
) -> Iterator[Item]:
    """Yield our models with small variations of size; a share `own_colours` keeps its own colours."""
    for kind in _deck(kinds, rng):
        yield of_model(kind, rng, own_colours)


def of_model(kind: str, rng: np.random.Generator, own_colours: float | None = None) -> Item:
    """Return one of our models, painted unless it keeps its own colours (with the given probability)."""
    paint = any_paint(rng, _TRUE_COLOURS.get(kind, _OWN_COLOURS) if own_colours is None else own_colours)
    return _thing(kind, varied_size(kind, rng), _natural_colour(kind, rng), paint)


def varied_size(kind: str, rng: np.random.Generator) -> Vec3:
    """Return the model's size with small random variations."""
    x, y, z = MODELS[kind].size_m * np.exp(rng.normal(0.0, 0.08) + rng.normal(0.0, 0.05, 3))
    return (float(x), float(y), float(z))


def varied_colour(kind: str, rng: np.random.Generator) -> Colour:
    """Return the model's colour with a random variation of light."""
    return _lit(MODELS[kind].colour, rng)


def _natural_colour(kind: str, rng: np.random.Generator) -> Colour:
    """Return a natural colour of the kind with a random variation of light; any colour without a model."""
    if kind in _RIPE:
        ripe = _RIPE[kind]
        return _lit(ripe[int(rng.integers(len(ripe)))], rng)
    return varied_colour(kind, rng) if kind in MODELS else _any_colour(rng)


def _any_colour(rng: np.random.Generator) -> Colour:
    red, green, blue = rng.uniform(0.05, 0.95, 3).tolist()
    return (red, green, blue)


def _lit(colour: Colour, rng: np.random.Generator) -> Colour:
    red, green, blue = np.clip(np.array(colour) + rng.normal(0.0, 0.05, 3), 0.0, 1.0).tolist()
    return (red, green, blue)


def _varieties(rng: np.random.Generator) -> Iterator[Item]:
    while True:
        for number in rng.permutation(len(VARIETIES)):
            variety = VARIETIES[number]
            size = any_size(variety, rng)
            while is_like_another(variety, size):
                size = any_size(variety, rng)
            paint = any_paint(rng, _TRUE_COLOURS.get(variety.model, _COLOURS_OF_A_MODEL))
            thing = _thing(variety.model, size, _natural_colour(variety.model, rng), paint)
            yield replace(thing, form=variety.form)


def _families(rng: np.random.Generator) -> Iterator[Item]:
    while True:
        for number in rng.permutation(len(FAMILIES)):
            family = FAMILIES[number]
            colour = _natural_colour(family.kind, rng)
            parts = drawn(family, colour, rng)
            paint = any_paint(rng, _TRUE_COLOURS.get(family.kind, _COLOURS_OF_A_MODEL))
            thing = _thing(family.kind.partition("@")[0], size_of(parts), colour, paint)
            yield replace(thing, form=_ready(parts), said=family.kind)


def _foreign(things: Sequence[ForeignThing], rng: np.random.Generator) -> Iterator[Item]:
    while things:
        for number in rng.permutation(len(things)):
            thing = things[number]
            larger = rng.uniform(-_FOREIGN_LARGER, _FOREIGN_LARGER)
            factors = np.exp(larger + rng.normal(0.0, _FOREIGN_STOUTER, 3))
            x, y, z = (factors * thing.size_m).tolist()
            grey = float(rng.uniform(0.1, 0.9))
            paint = any_paint(rng, _OWN_TEXTURE, texture_of(thing.mesh))
            drawn = _thing("foreign", (x, y, z), (grey, grey, grey), paint)
            yield replace(
                drawn, form=_form_of(thing), said=foreign_label(thing.name, thing.classes[0], new=thing.new)
            )


def _form_of(thing: ForeignThing) -> Form:
    return lambda x, y, z, colour: parts_of(thing, (x, y, z), colour)


def _distractors(rng: np.random.Generator) -> Iterator[Item]:
    while True:
        colour = _any_colour(rng)
        parts = distractor_parts(rng, colour)
        paint = any_paint(rng, _COLOURS_OF_A_MODEL)
        thing = _thing(DISTRACTOR, size_of(parts), colour, paint)
        yield replace(thing, form=_ready(parts), said=DISTRACTOR)


def _ready(parts: Parts) -> Form:
    return lambda _x, _y, _z, _colour: parts


def _thing(kind: str, size_m: Vec3, colour: Colour, paint: Paint) -> Item:
    return Item("", kind, size_m, colour, (0.0, 0.0, 0.0), 0.0, paint=paint)


def _deck(kinds: Sequence[str], rng: np.random.Generator) -> Iterator[str]:
    """Yield all kinds in random order, repeatedly."""
    while True:
        yield from (str(kind) for kind in rng.permutation(kinds))
