"""How large the simulator's models are, and what they carry and hold: data read off their geometry.

`ontology/model_shapes.json` is written by `make shapes`; a test compares it with the models.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Literal

import msgspec
from msgspec import Struct, structs

from semmap.ontology import MODEL_SHAPES_JSON
from semmap.schemas.entities import Size

Flat = tuple[float, float]
Corner = tuple[float, float, float]


class Surface(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A level patch that carries things: its height and the rectangle around it, in the model's frame [m].

    `fill` is the share of the rectangle that is really there (a disc has pi / 4).
    """

    height: float
    low: Flat
    high: Flat
    fill: float = 1.0


class Interior(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A hollow that holds things: its box in the model's frame [m]; `open` at the top, or closed.

    `behind` names the joints whose leaves close it: it is closed while all of these are shut. `carried_by`
    names the joint that carries it, as a drawer does; "" for a hollow of the model's frame.
    """

    low: Corner
    high: Corner
    fill: float = 1.0
    open: bool = True
    behind: tuple[str, ...] = ()
    carried_by: str = ""


class ConvexPart(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One convex part that collides, in the model's frame [m]: the Minkowski sum of what it names.

    Segments from -v to v (`straight`), an ellipsoid or a disc with these semi-axes (`round`), and the hull of
    some points (`points`), all around `centre`. A box is three segments, a cylinder a disc and a segment, a
    capsule a ball and a segment. However it is turned or stretched, it is one again.
    """

    centre: Corner
    straight: tuple[Corner, ...] = ()
    round: tuple[Corner, ...] = ()
    points: tuple[Corner, ...] = ()


class LeafShape(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """What one joint of a model moves: a door, a lid, a drawer.

    A hinge turns about `axis` through `anchor` [m], a slide shifts along it; all is in the model's frame, and
    as it is drawn the joint stands at 0. `limits` are the least and the greatest position [rad, m], `closed`
    is the one at which it is shut; None for a joint that opens nothing.
    """

    name: str
    kind: Literal["hinge", "slide"]
    anchor: Corner
    axis: Corner
    limits: Flat | None = None
    closed: float | None = None
    parts: tuple[int, ...] = ()
    """Which of the model's parts it moves."""
    surfaces: tuple[int, ...] = ()
    """Which of the model's surfaces it moves."""
    interiors: tuple[Interior, ...] = ()
    """The hollows that it carries, as it is drawn; while it is shut they are within those of the model."""


class ModelShape(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A model at the size `size_m`; an entity of another size has it stretched along each axis.

    `turns`: one that is long where the model is wide has it turned a quarter first, as the simulator does
    with the library's models. `leaves` are what moves; all else is as it is drawn, with every joint at 0.
    """

    size_m: Size
    surfaces: tuple[Surface, ...] = ()
    interiors: tuple[Interior, ...] = ()
    parts: tuple[ConvexPart, ...] = ()
    leaves: tuple[LeafShape, ...] = ()
    turns: bool = True
    of: tuple[str, ...] = ()
    """The models beside which it may be chosen for an entity (`model_choice.py`)."""
    words: tuple[str, ...] = ()
    """What it is called in names, beside its own name."""
    only_named: bool = False
    """Its size alone does not say it."""


def own_size_m(model: str) -> Size | None:
    """Extent of a model of the library along its own axes [m]; of "" that of the box which stands in for one.

    None for a model that is not known, as one from a file of the user's that `add_own` was not told of.
    """
    shape = shapes().get(model)
    return None if shape is None else shape.size_m


@cache
def shapes() -> dict[str, ModelShape]:
    """Model name to shape, for the library's models and the user's own."""
    return msgspec.json.decode(MODEL_SHAPES_JSON.read_bytes(), type=dict[str, ModelShape])


def varieties_of(model: str) -> tuple[str, ...]:
    """The models that may be chosen instead of one that the TBox names for a class."""
    return _varieties().get(model, ())


@cache
def _varieties() -> dict[str, tuple[str, ...]]:
    found: dict[str, tuple[str, ...]] = {}
    for name, shape in shapes().items():
        for model in shape.of:
            found[model] = (*found.get(model, ()), name)
    return found


def add_own(path: Path) -> None:
    """Take up the shapes of the user's own models, if there is such a file; before any is asked for.

    One in the place of a library's model stands for all that this stood for, without the library's
    varieties of it; one in the place of a variety is chosen as that was.
    """
    if not path.is_file():
        return
    known, own = shapes(), msgspec.json.decode(path.read_bytes(), type=dict[str, ModelShape])
    for name, shape in own.items():
        was = known.get(name)
        if was is not None:
            shape = structs.replace(shape, of=was.of, words=was.words, only_named=was.only_named)
        known[name] = shape
    for name, shape in known.items():
        if name not in own and not own.keys().isdisjoint(shape.of):
            known[name] = structs.replace(shape, of=tuple(model for model in shape.of if model not in own))
    _varieties.cache_clear()
