"""Creation, encoding and decoding of ROS 2 messages, by the definitions of one distribution."""

from __future__ import annotations

import functools
from typing import Any, Final

import numpy as np
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from semmap.nodes.bus.rmw import RosTopic
from semmap.nodes.extern.ros.definitions import DEFINITIONS
from semmap.schemas import errors

DISTRIBUTION: Final = Stores.ROS2_JAZZY
_BASE, _NAME, _ARRAY, _SEQUENCE = 1, 2, 3, 4
_QUATERNION: Final = "geometry_msgs/msg/Quaternion"
_NUMPY: Final = {"bool": np.bool_, "byte": np.uint8, "char": np.uint8}


@functools.cache
def store() -> Typestore:
    """Return the type store with all used types."""
    made = get_typestore(DISTRIBUTION)
    for name, text in DEFINITIONS.items():
        made.register(get_types_from_msg(text, name))
    return made


def topic(name: str, type_name: str, *, latched: bool = False, reliable: bool = True) -> RosTopic:
    """Return a topic with the hash of its type."""
    return RosTopic(name, type_name, store().hash_rihs01(type_name), latched, reliable)


def new(type_name: str, **fields: Any) -> Any:
    """Return a message; fields that are not set have the default values of ROS."""
    definitions = store().fielddefs[type_name][1]
    if type_name == _QUATERNION:
        fields = {"w": 1.0} | fields
    values = {name: fields.pop(name) if name in fields else _empty(kind) for name, kind in definitions}
    if fields:
        raise TypeError(f"{type_name} has no field {', '.join(fields)}")
    return store().types[type_name](**values)


def encode(message: Any) -> bytes:
    """Encode a message as CDR, little-endian."""
    return bytes(store().serialize_cdr(message, message.__msgtype__))


def decode(cdr: bytes, type_name: str) -> Any:
    """Decode a message from CDR. Raises BadRequest for invalid data."""
    try:
        return store().deserialize_cdr(cdr, type_name)
    except Exception as error:  # struct, NumPy and rosbags raise many types
        raise errors.BadRequest(f"not a {type_name}: {error}") from None


def _empty(kind: Any) -> Any:
    node, what = int(kind[0]), kind[1]
    if node == _BASE:
        name = what[0]
        return "" if name == "string" else False if name == "bool" else 0.0 if "float" in name else 0
    if node == _NAME:
        return new(what)
    (inner_node, inner), length = what
    if int(inner_node) == _BASE and inner[0] != "string":
        return np.zeros(length if node == _ARRAY else 0, _NUMPY.get(inner[0], inner[0]))
    return [_empty((inner_node, inner)) for _ in range(length if node == _ARRAY else 0)]
