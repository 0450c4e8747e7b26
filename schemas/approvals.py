"""Changes by agents that require a person's approval."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, Struct

Decision = Literal["waiting", "approved", "rejected", "withdrawn"]
Consequences = tuple[Annotated[str, Meta(max_length=1000)], ...]


class Request(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An agent's request for approval: `text` describes the change and `follows` its consequences.

    `agent` is the requester, and `by` is who decided. The request is identified by its `number`. It expires
    after an hour, or when the coordinator is restarted.
    """

    number: int
    agent: str
    text: str
    follows: Consequences = ()
    reason: str = ""
    stamp_ns: int
    decision: Decision = "waiting"
    by: str = ""
