"""Messages in rosbags and MCAP files of ROS 1 and 2.

They are decoded by our own definitions: a definition in a file may be recursive, or may make a message of a
few bytes an array of billions of values.
"""

from __future__ import annotations

import functools
import importlib
from bz2 import BZ2Decompressor
from collections.abc import Callable, Collection, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, Final

from mcap.reader import make_reader
from mcap.records import Schema
from rosbags.rosbag1 import Reader as Reader1
from rosbags.rosbag1.reader import decompressors
from rosbags.rosbag2 import Reader as Reader2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from semmap.nodes.extern.frame_folders.topics import TRANSFORMS
from semmap.nodes.extern.ros.types import store
from semmap.schemas.errors import BadFile

_SCHEMAS: Final = ("ros1msg", "ros2msg", "ros2idl")
"""The encodings of schemas of ROS messages."""
_MOST_BYTES: Final = 1 << 29
_TOO_LARGE: Final = "a chunk unpacks to more than 512 MB; record with smaller chunks"
Message = tuple[str, Any]
"""A topic and a message."""
Reader = Callable[[Collection[str]], Iterator[Message]]
"""A function that returns the messages of topics."""


class Bag:
    """A recording of topics, opened by `open_bag`."""

    def __init__(self, path: Path, types: dict[str, str], messages: Reader) -> None:
        """`types` are the message types by topic, such as `sensor_msgs/msg/Image`."""
        self.types = types
        self._path, self._messages = path, messages

    def messages(self, topics: Collection[str]) -> Iterator[Message]:
        """Yield the messages of some topics in the order of the recording. Raises BadFile."""
        with _readable(self._path):
            yield from self._messages(topics)


@contextmanager
def open_bag(path: Path) -> Iterator[Bag]:
    """Open a recording. Raises BadFile if it is not a recording, is damaged, or was not closed."""
    with ExitStack() as stack:
        with _readable(path):
            bag = _mcap(path, stack) if path.suffix.lower() == ".mcap" else _rosbag(path, stack)
        yield bag


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    try:
        yield
    except BadFile:
        raise
    except OSError as error:
        raise BadFile(f"{path} cannot be read: {error.strerror or error}") from None
    except MemoryError:  # a chunk may unpack to a million times its size, and lengths may be wrong
        raise BadFile(f"{path} needs more memory to read than this machine can give it") from None
    except Exception as error:  # rosbags and mcap raise many types for incomplete recordings
        reason = " ".join(str(error).split()) or type(error).__name__
        raise BadFile(f"{path} is damaged, truncated, or was not closed by its recorder: {reason}") from None


def _rosbag(path: Path, stack: ExitStack) -> Bag:
    reader: Any
    if path.suffix.lower() == ".bag":
        reader, decode = Reader1(path), _ros1().deserialize_ros1
    else:
        reader, decode = Reader2(path), store().deserialize_cdr
    stack.enter_context(reader)
    if path.suffix.lower() == ".bag":
        reader.chunks = {
            at: chunk._replace(decompressor=functools.partial(_unpack, chunk.decompressor))
            for at, chunk in reader.chunks.items()
        }

    def messages(topics: Collection[str]) -> Iterator[Message]:
        wanted = [connection for connection in reader.connections if connection.topic in topics]
        if not wanted:  # the reader would return all topics
            return
        for connection, _, raw in reader.messages(wanted):
            yield connection.topic, decode(raw, connection.msgtype)

    types = {connection.topic: connection.msgtype for connection in reader.connections}
    return Bag(path, types, messages)


def _mcap(path: Path, stack: ExitStack) -> Bag:
    reader = make_reader(stack.enter_context(path.open("rb")))
    summary = reader.get_summary()
    if summary is None:
        raise BadFile(f"{path} is truncated, or was not closed by its recorder: it has no summary")
    largest = max((chunk.uncompressed_size for chunk in summary.chunk_indexes), default=0)
    if largest > _MOST_BYTES:
        raise BadFile(f"{path}: {_TOO_LARGE}")

    def messages(topics: Collection[str]) -> Iterator[Message]:
        for schema, channel, message in reader.iter_messages(topics=list(topics)):
            if schema is not None and schema.encoding in _SCHEMAS:
                is_ros1 = channel.message_encoding == "ros1"
                decode = _ros1().deserialize_ros1 if is_ros1 else store().deserialize_cdr
                yield channel.topic, decode(message.data, _type(schema))

    return Bag(
        path,
        {
            channel.topic: _type(summary.schemas[channel.schema_id])
            for channel in summary.channels.values()
            if channel.schema_id in summary.schemas
        },
        messages,
    )


def _unpack(decompressor: Callable[[bytes], bytes], packed: bytes) -> bytes:
    """Return the content of a chunk of a ROS 1 bag. Raises ValueError if it is too large."""
    limited: Any
    if decompressor is decompressors["bz2"]:
        limited = BZ2Decompressor()
    elif decompressor is decompressors["lz4"]:
        limited = importlib.import_module("lz4.frame").LZ4FrameDecompressor()  # rosbags requires it
    else:
        return packed
    found = bytes(limited.decompress(packed, max_length=_MOST_BYTES))
    if not limited.eof:
        raise ValueError(_TOO_LARGE if len(found) >= _MOST_BYTES else "a chunk is truncated")
    return found


@functools.cache
def _ros1() -> Typestore:
    """Return the types of ROS 1, with those of `/tf`, which the store lacks."""
    types = get_typestore(Stores.ROS1_NOETIC)
    for name in TRANSFORMS:
        types.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", name))
    return types


def _type(schema: Schema) -> str:
    """Return the type of a schema; ROS 1 omits the middle part `msg`."""
    package, *_, name = schema.name.split("/")
    return f"{package}/msg/{name}" if package != name else name
