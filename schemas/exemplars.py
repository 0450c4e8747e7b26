"""Exemplars: objects that were shown to perception, so that it recognises them."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct, field

from semmap.schemas.entities import Size


class ShownView(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One view of an object.

    `features`: little-endian 32-bit floats, of shape and colours and then of the image, zeros without; their
    number depends on the version of perception. `size_m`: long side, short side, height.
    """

    features: Annotated[bytes, Meta(max_length=1 << 14)]
    size_m: Size


class LessonTold(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An exemplar and its class; `forget` removes it by its `number`.

    `size_m`: long side, short side, height. `shown`: a description of the origin of the views.
    """

    number: int
    class_: str = field(name="class")
    views: int
    size_m: Size
    shown: str
    stamp_ns: int
