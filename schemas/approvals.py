"""Changes that an agent may make only when a person has approved them."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, Struct

Decision = Literal["waiting", "approved", "rejected"]
Consequences = tuple[Annotated[str, Meta(max_length=1000)], ...]


class Request(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What an agent asks to be allowed to do: `text` says what, `follows` what would follow from it.

    `agent` is who asks, `by` who decided. It is known by its `number` until it is forgotten: an hour after it
    was asked, or when the coordinator is restarted.
    """

    number: int
    agent: str
    text: str
    follows: Consequences = ()
    reason: str = ""
    stamp_ns: int
    decision: Decision = "waiting"
    by: str = ""
