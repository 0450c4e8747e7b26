"""RPC requests with their reply types, so that mypy checks both ends.

`Get(name="cup1")` is a `Call[Entity]`: its sender gets an `Entity`, and its handler must return one.
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
    """A request with a reply of type R: `class Get(Call[Entity])`."""

    VERB: ClassVar[str]
    """The last chunk of the request's key; only commands also have it as a field of the message."""
    LARGEST: ClassVar[int] = 1 << 20
    """The maximum size of the encoded message [bytes]; larger content is sent as a document."""

    @property
    def is_quick(self) -> bool:
        """Whether the request is short and idempotent.

        Such a request is sent again if there is no reply for a minute.
        """
        return False

    @classmethod
    def answered_by(cls, function: Callable[[Self], R | Future[R] | Relay[R]]) -> Handler:
        """Pair this request type with its handler, which replies directly, later or through another node."""
        return Handler(cls, function)


class Handler(NamedTuple):
    """A request type and the function that handles it."""

    kind: type[Any]
    function: Callable[[Any], Any]


@dataclass(frozen=True)
class Relay(Generic[R]):
    """A reply that another node gives to `call` at `prefix/<verb>`, within `timeout_s`."""

    prefix: str
    call: Call[R]
    timeout_s: float


MANY: Final = 64 << 20
"""The maximum size of lists of names or poses [bytes]: about a million."""
DOCUMENT: Final = (1 << 30) + (1 << 20)
"""The maximum size of a message with a file [bytes]."""


def largest(kind: Any) -> int:
    """Return the maximum size of an encoded message of this type [bytes]."""
    return getattr(kind, "LARGEST", Call.LARGEST)


@cache
def reply_type(kind: type[Call[R]]) -> Any:
    """Return the reply type in the definition of a request type: `Entity` for `Get`."""
    for ancestor in kind.__mro__:
        for base in vars(ancestor).get("__orig_bases__", ()):
            arguments = get_args(base)
            if arguments and not isinstance(arguments[0], TypeVar) and isinstance(get_origin(base), type):
                return arguments[0]
    raise TypeError(f"{kind.__name__} has no reply type")


def by_verb(*handlers: Handler) -> dict[str, Handler]:
    """Return the handlers by the last chunk of their keys."""
    return {handler.kind.VERB: handler for handler in handlers}
