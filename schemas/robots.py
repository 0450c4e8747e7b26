"""Replies of several robots to one request."""

from __future__ import annotations

from typing import Generic, TypeVar

from msgspec import Struct

from semmap.schemas import errors

R = TypeVar("R")


class Answer(Struct, Generic[R], frozen=True, kw_only=True):
    """A robot's reply, for its map after commit `commit`, or the `error` that it returned."""

    robot: str
    """Its name; empty for a system without a name."""
    commit: int | None = None
    reply: R | None = None
    error: errors.ErrorMessage | None = None

    @property
    def value(self) -> R:
        """The reply. Raises the robot's error."""
        if self.error is not None:
            raise errors.from_message(self.error)
        if self.reply is None:
            raise errors.InternalError("the robot gave neither a reply nor an error")
        return self.reply
