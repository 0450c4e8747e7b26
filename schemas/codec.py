"""Encoding and decoding: MessagePack, JSON, and the text parameters of a selector."""

from __future__ import annotations

import gc
import re
import threading
import types
from collections.abc import Mapping
from typing import Any, Final, TypeVar, Union, get_args, get_origin

import msgspec

from semmap.schemas.errors import BadRequest, shortened
from semmap.schemas.wording import sentence

T = TypeVar("T")

MALFORMED: Final = "malformed message: "
"""How an error about a message that cannot be read begins."""
_JSON: Final = re.compile(rb"\s*\{")
_LARGE: Final = 1 << 18
"""Bytes from which no garbage is collected while a message is read: none of what that makes is garbage, and
looking through it again and again takes twice as long as reading it."""
_encoder = msgspec.msgpack.Encoder()
_decoders: dict[Any, msgspec.msgpack.Decoder[Any]] = {}
_preparing = threading.Lock()


def encode(message: Any) -> bytes:
    """`message` as MessagePack.

    Raises BadRequest for text that cannot be written as UTF-8, and for whole numbers of more than 64 bits.
    """
    try:
        return _encoder.encode(message)
    except UnicodeEncodeError as error:
        raise BadRequest(f"a text is not UTF-8: {shortened(repr(error.object))}") from None
    except OverflowError:
        raise BadRequest("a whole number is too large to be sent: it has more than 64 bits") from None


def encode_json(message: Any) -> bytes:
    """`message` as JSON, indented for people; bytes become base64."""
    return msgspec.json.format(msgspec.json.encode(message), indent=2)


def decode(payload: bytes | bytearray, kind: type[T] | Any) -> T:
    """The message in `payload`, MessagePack or a JSON object. Raises BadRequest naming the field at fault.

    Nothing is unpacked: a message takes memory in proportion to its own size.
    """
    pauses = len(payload) >= _LARGE and gc.isenabled()
    if pauses:
        gc.disable()
    try:
        if looks_like_json(payload):
            return msgspec.json.decode(payload, type=prepared(kind))
        return (_decoders.get(kind) or decoder(kind)).decode(payload)  # type: ignore[no-any-return]
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise BadRequest(f"{MALFORMED}{sentence(error, kind)}") from None
    finally:
        if pauses:
            gc.enable()


def decoder(kind: Any) -> msgspec.msgpack.Decoder[Any]:
    """The decoder of MessagePack for `kind`; any thread may ask for it at any time.

    When msgspec (0.22.0) first meets a struct it keeps what it finds out about it with the struct, and that
    before it has found out everything. Another thread that meets the same struct at that moment works with
    the half, and the process ends with a segmentation fault. So only one thread at a time may let msgspec
    meet a type: by this function, or by `prepared`.
    """
    with _preparing:
        if (made := _decoders.get(kind)) is None:
            made = _decoders[kind] = msgspec.msgpack.Decoder(kind)
        return made


def prepared(kind: T) -> T:
    """`kind`, fit to be given to any function of msgspec's on any thread; see `decoder`."""
    if kind not in _decoders:
        decoder(kind)
    return kind


def from_text(parameters: Mapping[str, str], kind: type[T]) -> T:
    """A message from selector parameters: vectors as `1,2,0`, lists of text as `a|b`.

    Raises BadRequest naming the parameter at fault.
    """
    fields = {field.encode_name: field.type for field in msgspec.structs.fields(kind)}  # type: ignore[arg-type]
    values = {key: _split(text, fields.get(key, str)) for key, text in parameters.items()}
    return convert(values, kind, strict=False)


def convert(values: Any, kind: type[T], *, strict: bool = True) -> T:
    """Plain data as a message. Raises BadRequest."""
    try:
        return msgspec.convert(values, type=prepared(kind), strict=strict)
    except msgspec.MsgspecError as error:
        raise BadRequest(f"{MALFORMED}{sentence(error, kind)}") from None


def looks_like_json(payload: bytes | bytearray) -> bool:
    """A JSON object begins with a brace, which no MessagePack map does."""
    first = payload[:1]
    return first == b"{" or (first.isspace() and _JSON.match(payload) is not None)


def encoding_of(message: Any) -> str:
    """The Zenoh encoding that goes with `message`, schema included."""
    return f"application/msgpack;semmap.{type(message).__name__}.v1"


def _split(text: str, kind: Any) -> Any:
    if kind is bool and not text:
        return True  # a parameter without a value: `semmap/cmd/add?class=Chair;wait`
    members = get_args(kind) if get_origin(kind) in (Union, types.UnionType) else (kind,)
    for member in members:
        if get_origin(member) is tuple:
            inner = get_args(member)
            return re.split(r"[|,]" if Ellipsis not in inner else r"[|]", text)
    return text


def as_json(payload: bytes) -> str:
    """Any payload on one line for bare eyes: MessagePack or JSON as JSON, else its size."""
    try:
        if looks_like_json(payload):
            return msgspec.json.format(payload, indent=-1).decode()
        return msgspec.json.encode(msgspec.msgpack.decode(payload)).decode()
    except (msgspec.MsgspecError, UnicodeDecodeError):
        return f"{len(payload)} bytes"
