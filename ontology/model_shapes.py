"""Sizes, support surfaces and interiors of the simulator's models, computed from their geometry.

`ontology/model_shapes.json` is written by `make shapes`; a test compares it with the models.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from functools import cache
from itertools import chain
from pathlib import Path
from typing import Literal

import msgspec
from msgspec import Struct, structs

from semmap.ontology import MODEL_SHAPES_JSON
from semmap.schemas.entities import Size

Flat = tuple[float, float]
Corner = tuple[float, float, float]


class Surface(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A horizontal support surface: its height and bounding rectangle, in the model's frame [m].

    `fill` is the share of the rectangle that it covers (pi / 4 for a disc).
    """

    height: float
    low: Flat
    high: Flat
    fill: float = 1.0


class Interior(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """An interior that can contain things: its box in the model's frame [m]; `open` at the top, or closed.

    Seen from above, a `round` one is the ellipse in the rectangle of its box, such as that of a bowl.
    `behind` are the joints whose leaves close it: it is closed while all of them are closed. `carried_by` is
    the joint that it moves with, such as that of a drawer; "" for a static interior. A `filled` one is solid
    in the simulator, such as that of a cup, so nothing can be placed in it there. A `shallow` one, such as
    that of a tray, contains nothing: things are on it.
    """

    low: Corner
    high: Corner
    fill: float = 1.0
    round: bool = False
    open: bool = True
    behind: tuple[str, ...] = ()
    carried_by: str = ""
    filled: bool = False
    shallow: bool = False

    @property
    def is_sealed(self) -> bool:
        """Return whether nothing can get in from outside, such as into a can."""
        return self.filled and not self.open


class ConvexPart(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A convex collision part in the model's frame [m]: the Minkowski sum of its components.

    The components are segments from -v to v (`straight`), an ellipsoid or disc with these semi-axes
    (`round`), and the convex hull of points (`points`), all around `centre`. A box is three segments, a
    cylinder a disc and a segment, a capsule a ball and a segment. The form is closed under rotation and
    scaling.
    """

    centre: Corner
    straight: tuple[Corner, ...] = ()
    round: tuple[Corner, ...] = ()
    points: tuple[Corner, ...] = ()


class LeafShape(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """The part of a model that one joint moves: a door, a lid, a drawer.

    A hinge rotates about `axis` through `anchor` [m], a slide moves along it, in the model's frame with the
    joint at 0. `limits` are the lowest and highest position [rad, m]. `closed` is the position at which it is
    closed; None for a joint that opens nothing.
    """

    name: str
    kind: Literal["hinge", "slide"]
    anchor: Corner
    axis: Corner
    limits: Flat | None = None
    closed: float | None = None
    parts: tuple[int, ...] = ()
    """Indices of the model's parts that it moves."""
    surfaces: tuple[int, ...] = ()
    """Indices of the model's surfaces that it moves."""
    interiors: tuple[Interior, ...] = ()
    """The interiors that move with it, with the joint at 0; when closed, they are inside the model's."""


class ModelShape(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """The shape of a model at the size `size_m`; for an entity of another size it is scaled along each axis.

    With `turns`, the model is first rotated by 90 degrees if that matches the entity's proportions better, as
    in the simulator. `leaves` are the moving parts; all shapes are given with the joints at 0.
    """

    size_m: Size
    surfaces: tuple[Surface, ...] = ()
    interiors: tuple[Interior, ...] = ()
    parts: tuple[ConvexPart, ...] = ()
    leaves: tuple[LeafShape, ...] = ()
    turns: bool = True
    of: tuple[str, ...] = ()
    """The models of which it is a variety (`model_choice.py`)."""
    words: tuple[str, ...] = ()
    """Further words for it in entity names."""
    only_named: bool = False
    """Whether it is chosen only by name, not by size."""


class WorldShapes(Struct, frozen=True, forbid_unknown_fields=True):
    """The shapes of the bodies of world files.

    `shapes` are by digest: equal bodies share one, and the bodies of two worlds are not mistaken for one
    another. `bodies` are the digests of each body by name: first that of the present world, then those of
    other sizes in earlier worlds, the latest first, for past commits.
    """

    shapes: dict[str, ModelShape] = {}
    bodies: dict[str, tuple[str, ...]] = {}

    @classmethod
    def of(cls, by_name: Mapping[str, ModelShape]) -> WorldShapes:
        """Return the shapes of bodies by name."""
        digests = {name: _digest(shape) for name, shape in by_name.items()}
        return cls(
            {digests[name]: shape for name, shape in by_name.items()},
            {name: (digest,) for name, digest in digests.items()},
        )

    def followed_by(self, later: WorldShapes) -> WorldShapes:
        """Return the shapes with those of a later world, and those of its bodies at earlier sizes."""
        known = {**self.shapes, **later.shapes}
        bodies = dict(self.bodies)
        for name, (now, *_) in later.bodies.items():
            size_m = known[now].size_m
            earlier = self.bodies.get(name, ())
            bodies[name] = (now, *(was for was in earlier if not is_same_size(known[was].size_m, size_m)))
        used = set(chain.from_iterable(bodies.values()))
        return WorldShapes({digest: shape for digest, shape in known.items() if digest in used}, bodies)


class AddedShapes(Struct, frozen=True):
    """The shapes that are not of the library, for another process."""

    own: dict[str, ModelShape] = {}
    world: WorldShapes = WorldShapes()


_own: dict[str, ModelShape] = {}
_WORLD = "world/"
"""Begins the digests of shapes of the world, which no model's name does."""
_world = WorldShapes()


def own_size_m(model: str) -> Size | None:
    """Return the extent of a model along its own axes [m]; "" stands for the default box.

    It is None for an unknown model, such as a user's file that was not added by `add_own`.
    """
    shape = shape_named(model)
    return None if shape is None else shape.size_m


def shape_named(model: str) -> ModelShape | None:
    """Return the shape of a model, or of a body of the world by its digest, at its own size."""
    return _world.shapes.get(model) or shapes().get(model)


def model_in_world(name: str, model: str, size_m: Size | None) -> str:
    """Return the model that stands for the shape of the entity `name`.

    It is the digest of its body in the world file if that has this size, or of its latest body of this size
    in an earlier world, else `model`. A body that was created again at another size has the shape of the
    model.
    """
    for digest in _world.bodies.get(name, ()):
        if size_m is None or is_same_size(size_m, _world.shapes[digest].size_m):
            return digest
    return model


def is_of_world(model: str) -> bool:
    """Return whether a result of `model_in_world` is a body of the world file."""
    return model in _world.shapes


def world() -> WorldShapes:
    """Return the shapes of the bodies of world files."""
    return _world


def exchange_world(shapes: WorldShapes) -> None:
    """Replace the shapes of the bodies of world files."""
    global _world
    _world = shapes


def _digest(shape: ModelShape) -> str:
    return _WORLD + hashlib.blake2b(msgspec.json.encode(shape), digest_size=16).hexdigest()


def read_shapes(path: Path) -> dict[str, ModelShape]:
    """Return the shapes in a file, by name."""
    return decode_shapes(path.read_bytes())


def decode_shapes(content: bytes | str) -> dict[str, ModelShape]:
    """Return the shapes in the content of a file, by name."""
    return msgspec.json.decode(content, type=dict[str, ModelShape])


def added_shapes() -> AddedShapes:
    """Return the shapes that are not of the library, for another process: see `add_shapes`."""
    return AddedShapes(_own, _world)


def add_shapes(added: AddedShapes) -> None:
    """Add the shapes of another process."""
    shapes().update(added.own)
    exchange_world(added.world)


def is_same_size(one: Size, other: Size) -> bool:
    """Return whether a body of the first size is one of the other, to a millimetre and a percent of it."""
    return all(abs(a - b) <= 0.001 + 0.01 * b for a, b in zip(one, other, strict=True))


@cache
def shapes() -> dict[str, ModelShape]:
    """Return the shapes of the library's and the user's models by name."""
    return read_shapes(MODEL_SHAPES_JSON)


def varieties_of(model: str) -> tuple[str, ...]:
    """Return the models that can be chosen instead of the model of a class in the TBox."""
    return _varieties().get(model, ())


@cache
def _varieties() -> dict[str, tuple[str, ...]]:
    found: dict[str, tuple[str, ...]] = {}
    for name, shape in shapes().items():
        for model in shape.of:
            found[model] = (*found.get(model, ()), name)
    return found


def add_own(path: Path) -> None:
    """Add the shapes of the user's models from a file, if it exists. Must be called before any look-up.

    A model with the name of a library model replaces it and its varieties. A model with the name of a variety
    replaces that variety.
    """
    if not path.is_file():
        return
    known, own = shapes(), read_shapes(path)
    for name, shape in own.items():
        was = known.get(name)
        if was is not None:
            shape = structs.replace(shape, of=was.of, words=was.words, only_named=was.only_named)
        known[name] = _own[name] = shape
    for name, shape in known.items():
        if name not in own and not own.keys().isdisjoint(shape.of):
            known[name] = structs.replace(shape, of=tuple(model for model in shape.of if model not in own))
    _varieties.cache_clear()
