"""Which of the models of a class an entity has: the one that its name says, or that its size is nearest to.

A class has the model that the TBox names for it, and the library's varieties of that one. The choice is a
function of the map alone, so that every process comes to the same.
"""

from __future__ import annotations

import math
import re
from collections.abc import Set
from functools import cache, lru_cache

from semmap.ontology.model_shapes import own_size_m, shapes, varieties_of
from semmap.schemas import errors
from semmap.schemas.entities import Size

_WORD = re.compile(r"[A-Z]?[^\W\d_A-Z]+|[A-Z]+(?![^\W\d_A-Z])")
_DIGITS = "0123456789"
"""They are in no word: `cup1` and `cup2` say the same."""


def chosen(model: str, name: str, size_m: Size | None) -> str:
    """The model of an entity called `name`, of a class that has the model `model`.

    Among several that its name says, and among all where it says none, the one that is nearest in size
    counts; without a size (None) the one that is nearest to `model`.
    """
    if not varieties_of(model):
        return model
    candidates = _said_by(model, name.rstrip(_DIGITS))
    if not candidates:
        if size_m is None:
            return model
        candidates = _told_by_size(model)
    size_m = size_m or own_size_m(model)
    if size_m is None or len(candidates) == 1:
        return candidates[0]
    return _nearest(candidates, size_m)


def require_model(text: str) -> None:
    """Raises BadRequest with the nearest names for what is neither a model's name nor that of a file."""
    if (text and text in shapes()) or "." in text:
        return
    hint = errors.did_you_mean(text, [name for name in shapes() if name])
    files = "; a file of one's own is named with its ending, as chair.glb"
    raise errors.BadRequest(f"unknown model '{text}'{hint or files}")


@cache
def _told_by_size(model: str) -> tuple[str, ...]:
    return (model, *(variety for variety in varieties_of(model) if not shapes()[variety].only_named))


@lru_cache(maxsize=4096)
def _said_by(model: str, name: str) -> tuple[str, ...]:
    """The varieties of which the most words are in a name, as in `wine_glass2`, `WineGlass`, `wineglass`."""
    words = {word.lower() for word in _WORD.findall(name)}
    found = {variety: _said(variety, words, model) for variety in varieties_of(model)}
    most = max(found.values(), default=0)
    return tuple(variety for variety, count in found.items() if count == most > 0)


def _said(variety: str, words: Set[str], model: str) -> int:
    """How many words a name has of what a variety is called; what is said of `model` as well says nothing."""
    own = set(model.split("_"))
    terms = [term.split() for term in (variety.replace("_", " "), *shapes()[variety].words)]
    said = (t for t in terms if not own.issuperset(t) and (words >= set(t) or "".join(t) in words))
    return max(map(len, said), default=0)


def _nearest(candidates: tuple[str, ...], size_m: Size) -> str:
    """The model that is nearest to a size.

    How far off one is: the squared logarithms of the ratios of extents, and once more of proportions. That of
    proportions, in which the mean is taken off each, is the former less a third of their sum squared.
    """
    x, y, z = map(math.log, size_m)
    nearest, least = candidates[0], math.inf
    for model in candidates:  # this runs for every entity of a load
        if (own := _logarithms(model)) is None:
            continue
        (a, b, c), turns = own
        floor = (x - a) ** 2 + (y - b) ** 2
        if turns:
            floor = min(floor, (y - a) ** 2 + (x - b) ** 2)
        apart = 2.0 * (floor + (z - c) ** 2) - (x - a + y - b + z - c) ** 2 / 3.0
        if apart < least:
            nearest, least = model, apart
    return nearest


@cache
def _logarithms(model: str) -> tuple[tuple[float, float, float], bool] | None:
    """Of a model's extents, and whether it may be turned; None for one that is not known."""
    shape = shapes().get(model)
    if shape is None:
        return None
    x, y, z = map(math.log, shape.size_m)
    return (x, y, z), shape.turns
