"""Methods that send a command: a function of a client that waits, and a coroutine of one that does not.

A `CommandMethod` has the parameters of the command's constructor, so type checkers and editors see
`client.add(class_, name=None, at=None, ...) -> Changed`. So do `help(client.add)` and `inspect.signature`.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Coroutine
from functools import cached_property, partial
from types import MethodType
from typing import TYPE_CHECKING, Any, Generic, ParamSpec, TypeVar, get_args, get_type_hints, overload

from semmap.schemas.calls import reply_type
from semmap.schemas.commands import Command

if TYPE_CHECKING:
    from semmap.nodes.extern.async_client import AsyncClient
    from semmap.nodes.extern.client import Client

P = ParamSpec("P")
R = TypeVar("R")
U = TypeVar("U")


class CommandMethod(Generic[P, U]):
    """A method that makes a command with `make`, sends it, and returns the reply, converted by `read`.

    It is a function of a `Client` and a coroutine of an `AsyncClient`. Its types and documentation are those
    of `make`.
    """

    @overload
    def __init__(self: CommandMethod[P, R], make: Callable[P, Command[R]]) -> None: ...
    @overload
    def __init__(
        self: CommandMethod[P, U], make: Callable[P, Command[R]], read: Callable[[R], U]
    ) -> None: ...
    def __init__(self, make: Callable[..., Command[Any]], read: Callable[[Any], Any] | None = None) -> None:
        self._make, self._read = make, read

    def __set_name__(self, owner: type[Any], name: str) -> None:
        self._owner, self._name = owner.__name__, name

    @cached_property
    def _method(self) -> Callable[..., Any]:
        """The function of this method. It is made at first use, because making the signatures is slow."""
        make, read = self._make, self._read

        def method(client: Any, *args: Any, **fields: Any) -> Any:
            return client.request(partial(make, *args, **fields), read)

        method.__name__, method.__qualname__ = self._name, f"{self._owner}.{self._name}"
        method.__doc__, method.__module__ = make.__doc__, make.__module__
        method.__signature__ = _signature(make, read)  # type: ignore[attr-defined]
        return method

    @overload
    def __get__(self, client: Client, owner: type[Client]) -> Callable[P, U]: ...
    @overload
    def __get__(
        self, client: AsyncClient, owner: type[AsyncClient]
    ) -> Callable[P, Coroutine[Any, Any, U]]: ...
    @overload
    def __get__(self, client: None, owner: type[Any]) -> Callable[..., Any]: ...
    def __get__(self, client: Any, owner: type[Any]) -> Any:
        return self._method if client is None else MethodType(self._method, client)


def _signature(make: Callable[..., Any], read: Callable[[Any], Any] | None) -> inspect.Signature:
    """Return the signature of `make` as a method, with the type of the reply, and types as in the code."""
    signature = inspect.signature(make)
    written = _annotations_of(make) if isinstance(make, type) else {}
    parameters = [p.replace(annotation=written.get(n, p.annotation)) for n, p in signature.parameters.items()]
    if read is not None:
        reply = get_type_hints(read)["return"]
    elif isinstance(make, type):
        reply = reply_type(make)
    else:
        (reply,) = get_args(get_type_hints(make)["return"])
    itself = inspect.Parameter("self", inspect.Parameter.POSITIONAL_ONLY)
    return signature.replace(parameters=[itself, *parameters], return_annotation=reply)


def _annotations_of(kind: type[Any]) -> dict[str, Any]:
    return {
        name: annotation
        for base in reversed(kind.__mro__)
        for name, annotation in inspect.get_annotations(base).items()
    }
