"""Selection of an entity's model among those of its class: by its name, or else by the closest size.

The models of a class are the one in the TBox and the library's varieties of it. The selection depends only
on the map, so that all processes get the same result.
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
"""Digits are ignored in names: `cup1` and `cup2` select the same model."""


def chosen(model: str, name: str, size_m: Size | None) -> str:
    """Return the model of the entity `name`, whose class has the model `model`.

    Candidates are the models that match the name, or all if none does. The one with the closest size is
    chosen; without a size (None), the one closest to `model`.
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
    """Raise BadRequest with similar names for a text that is neither a model nor a file name."""
    if (text and text in shapes()) or "." in text:
        return
    hint = errors.did_you_mean(text, [name for name in shapes() if name])
    files = "; to use a file of your own, give its name with the extension, such as chair.glb"
    raise errors.BadRequest(f"unknown model '{text}'{hint or files}")


@cache
def _told_by_size(model: str) -> tuple[str, ...]:
    return (model, *(variety for variety in varieties_of(model) if not shapes()[variety].only_named))


@lru_cache(maxsize=4096)
def _said_by(model: str, name: str) -> tuple[str, ...]:
    """Return the varieties with the most words in a name, such as `wine_glass2`, `WineGlass`, `wineglass`."""
    words = {word.lower() for word in _WORD.findall(name)}
    found = {variety: _said(variety, words, model) for variety in varieties_of(model)}
    most = max(found.values(), default=0)
    return tuple(variety for variety, count in found.items() if count == most > 0)


def _said(variety: str, words: Set[str], model: str) -> int:
    """Return the number of words of a variety in a name, excluding words of `model`."""
    own = set(model.split("_"))
    terms = [term.split() for term in (variety.replace("_", " "), *shapes()[variety].words)]
    found = (t for t in terms if not own.issuperset(t) and (words >= set(t) or "".join(t) in words))
    return max(map(len, found), default=0)


def _nearest(candidates: tuple[str, ...], size_m: Size) -> str:
    """Return the model with the closest size.

    The distance is the sum of the squared logarithms of the ratios of extents, plus the same for proportions.
    The latter, with the mean subtracted, is the former less a third of the squared sum.
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
    """Return the logarithms of a model's extents, and whether it can be rotated; None if it is unknown."""
    shape = shapes().get(model)
    if shape is None:
        return None
    x, y, z = map(math.log, shape.size_m)
    return (x, y, z), shape.turns
