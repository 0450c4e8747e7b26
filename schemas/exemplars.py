"""What people have shown perception, so that it knows it again."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct, field

from semmap.schemas.entities import Size


class ShownView(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A thing as it was seen once.

    `features`: little-endian 32-bit floats, as many as this version of perception looks at. `size_m`: long
    side, short side, height.
    """

    features: Annotated[bytes, Meta(max_length=1 << 14)]
    size_m: Size


class LessonTold(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What was shown, and of which class it is; forgotten by its `number`.

    `size_m`: long side, short side, height. `shown`: where it was seen, in words.
    """

    number: int
    class_: str = field(name="class")
    views: int
    size_m: Size
    shown: str
    stamp_ns: int
