"""What violates a SHACL shape, in terms."""

from __future__ import annotations

from msgspec import Struct

from semmap.schemas.explanations import Term


class Result(Struct, frozen=True):
    """A fact that violates a shape."""

    focus: Term
    """The individual or value that the shape is about."""
    message: str
    """The message of the shape, or ""."""
    path: str
    """The property path from the individual to the value, with IRIs in <>; "" if the shape has none."""
    value: Term
    """The value that violates the shape, or ""."""
    severity: str
    shape: Term
    constraint: str = ""
    """The violated constraint, such as "sh:minCount 1"."""
