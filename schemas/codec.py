"""Encoding and decoding: MessagePack, JSON, and the text parameters of a selector."""

from __future__ import annotations

import codecs
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
"""The beginning of an error about an invalid message."""
_JSON: Final = re.compile(rb"\s*\{")
_LARGE: Final = 1 << 18
"""The size from which garbage collection is disabled while a message is decoded [bytes].

Decoding creates no garbage, and collections during it would triple its duration."""
_encoder = msgspec.msgpack.Encoder()
_decoders: dict[Any, msgspec.msgpack.Decoder[Any]] = {}
_preparing = threading.Lock()


def encode(message: Any) -> bytes:
    """Encode a message as MessagePack.

    Raises BadRequest for text that cannot be encoded as UTF-8, and for integers of more than 64 bits.
    """
    try:
        return _encoder.encode(message)
    except UnicodeEncodeError as error:
        raise BadRequest(f"a text is not UTF-8: {shortened(repr(error.object))}") from None
    except OverflowError:
        raise BadRequest("an integer has more than 64 bits") from None


def encode_json(message: Any) -> bytes:
    """Encode a message as indented JSON; bytes become base64."""
    return msgspec.json.format(msgspec.json.encode(message), indent=2)


def decode(payload: bytes | bytearray, kind: type[T] | Any) -> T:
    """Decode a message from MessagePack or a JSON object. Raises BadRequest with the invalid field.

    Compressed content stays compressed, so the memory is proportional to the size of the message.
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


def decode_text(content: bytes) -> str:
    """Return the text of a file in UTF-8, or in UTF-16 with a byte order mark, without that mark.

    Raises UnicodeDecodeError for other content.
    """
    utf16 = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    return content.decode("utf-16" if utf16 else "utf-8-sig")


def decode_json(text: str) -> Any:
    """Return the value in JSON. Raises DecodeError of msgspec, also if it is nested too deeply."""
    try:
        return msgspec.json.decode(text)
    except RecursionError:
        raise msgspec.DecodeError("nested too deeply") from None


def decoder(kind: Any) -> msgspec.msgpack.Decoder[Any]:
    """Return the MessagePack decoder for `kind`. Thread-safe.

    When msgspec (0.22.0) first inspects a struct, it caches the result on the struct before it is complete.
    If another thread uses the struct at that moment, the process crashes with a segmentation fault.
    Therefore, types must be registered with msgspec by one thread at a time: by this function or `prepared`.
    """
    with _preparing:
        if (made := _decoders.get(kind)) is None:
            made = _decoders[kind] = msgspec.msgpack.Decoder(kind)
        return made


def prepared(kind: T) -> T:
    """Return `kind` after registering it, so that any thread can pass it to msgspec; see `decoder`."""
    if kind not in _decoders:
        decoder(kind)
    return kind


def from_text(parameters: Mapping[str, str], kind: type[T]) -> T:
    """Create a message from selector parameters: vectors as `1,2,0`, lists of text as `a|b`.

    Raises BadRequest with the invalid parameter.
    """
    fields = {field.encode_name: field.type for field in msgspec.structs.fields(kind)}  # type: ignore[arg-type]
    values = {key: _split(text, fields.get(key, str)) for key, text in parameters.items()}
    return convert(values, kind, strict=False)


def convert(values: Any, kind: type[T], *, strict: bool = True) -> T:
    """Convert plain data to a message. Raises BadRequest."""
    try:
        return msgspec.convert(values, type=prepared(kind), strict=strict)
    except msgspec.MsgspecError as error:
        raise BadRequest(f"{MALFORMED}{sentence(error, kind)}") from None


def looks_like_json(payload: bytes | bytearray) -> bool:
    """Return whether a payload is a JSON object: it begins with a brace, unlike any MessagePack map."""
    first = payload[:1]
    return first == b"{" or (first.isspace() and _JSON.match(payload) is not None)


def encoding_of(message: Any) -> str:
    """Return the Zenoh encoding of a message, including its schema."""
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
    """Return any payload as one line of text: MessagePack or JSON as JSON, otherwise its size."""
    try:
        if looks_like_json(payload):
            return msgspec.json.format(payload, indent=-1).decode()
        return msgspec.json.encode(msgspec.msgpack.decode(payload)).decode()
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError):
        return f"{len(payload)} bytes"
