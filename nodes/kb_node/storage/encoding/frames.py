"""Frames: parts of a large body that are compressed one by one, in parallel with other work."""

from __future__ import annotations

import zlib
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from types import TracebackType

from semmap.nodes.kb_node.storage.encoding import body_encoding


class FrameCompressor:
    """A thread that compresses frames while the next ones are created. Use it in a `with`."""

    def __init__(self) -> None:
        self._executor = ThreadPoolExecutor(1)

    def __enter__(self) -> FrameCompressor:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._executor.shutdown()

    def compress(self, frame: bytes) -> Future[bytes]:
        """Compress a frame in the background."""
        return self._executor.submit(zlib.compress, frame, body_encoding.COMPRESSION_LEVEL)


def decompress_frames(frames: Sequence[bytes]) -> Iterator[bytes]:
    """Yield each frame decompressed. The next one is decompressed meanwhile."""
    with ThreadPoolExecutor(1) as executor:
        ahead = deque[Future[bytes]]()
        for frame in frames:
            ahead.append(executor.submit(zlib.decompress, frame))
            if len(ahead) > 1:
                yield ahead.popleft().result()
        while ahead:
            yield ahead.popleft().result()
