"""Calls: messages that are answered, each with the type of its answer, so that mypy checks the wire.

`Get(name="cup1")` is a `Call[Entity]`: who sends it gets an `Entity`, and who serves it must give one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, Final, Generic, NamedTuple, Self, get_args, get_origin

from msgspec import Struct

if TYPE_CHECKING:
    from concurrent.futures import Future

    from typing_extensions import TypeVar

    R = TypeVar("R", default=Any)
else:
    from typing import TypeVar

    R = TypeVar("R")


class Call(Struct, Generic[R], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A message whose answer is an R: `class Get(Call[Entity])`."""

    VERB: ClassVar[str]
    """The last chunk of the key at which it is asked; it is a field of the message in commands only."""
    LARGEST: ClassVar[int] = 1 << 20
    """Bytes that such a message may have, encoded. What takes more than that to say is said in a document."""

    @property
    def is_quick(self) -> bool:
        """Is it answered in moments by one who is not busy, and does it do no more when it is asked twice?

        Such a call is asked anew when a minute has brought no answer.
        """
        return False

    @classmethod
    def answered_by(cls, function: Callable[[Self], R | Future[R] | Relay[R]]) -> Handler:
        """Pair this type of call with the function that answers it, at once, later, or by another node."""
        return Handler(cls, function)


class Handler(NamedTuple):
    """A type of call, and the function that answers such calls."""

    kind: type[Any]
    function: Callable[[Any], Any]


@dataclass(frozen=True)
class Relay(Generic[R]):
    """The answer that another node gives to `call` at `prefix/<verb>`, waited for up to `timeout_s`."""

    prefix: str
    call: Call[R]
    timeout_s: float


MANY: Final = 64 << 20
"""Bytes: names or poses of a million things."""
DOCUMENT: Final = (1 << 30) + (1 << 20)
"""Bytes: a file, as large as one is read, and what goes with it."""


def largest(kind: Any) -> int:
    """How many bytes a message of this type may have, encoded."""
    return getattr(kind, "LARGEST", Call.LARGEST)


@cache
def reply_type(kind: type[Call[R]]) -> Any:
    """The type of the answers to calls of this type, as its definition says: `Entity` for `Get`."""
    for ancestor in kind.__mro__:
        for base in vars(ancestor).get("__orig_bases__", ()):
            said = get_args(base)
            if said and not isinstance(said[0], TypeVar) and isinstance(get_origin(base), type):
                return said[0]
    raise TypeError(f"{kind.__name__} does not say what it is answered with")


def by_verb(*handlers: Handler) -> dict[str, Handler]:
    """Handlers by the verbs that they serve."""
    return {handler.kind.VERB: handler for handler in handlers}
