"""Frames: pieces of a large body that are compressed one by one, beside other work."""

from __future__ import annotations

import zlib
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from types import TracebackType

from semmap.nodes.kb_node.storage.encoding import dense


class Compressing:
    """A thread that compresses frames while the next ones are made; to be used in a `with`."""

    def __init__(self) -> None:
        self._beside = ThreadPoolExecutor(1)

    def __enter__(self) -> Compressing:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._beside.shutdown()

    def dense(self, frame: bytes) -> Future[bytes]:
        """A frame, compressed."""
        return self._beside.submit(zlib.compress, frame, dense.DENSITY)


def unpacked(frames: Sequence[bytes]) -> Iterator[bytes]:
    """Each frame as it was; the next one is unpacked while the last one is read."""
    with ThreadPoolExecutor(1) as beside:
        ahead = deque[Future[bytes]]()
        for frame in frames:
            ahead.append(beside.submit(zlib.decompress, frame))
            if len(ahead) > 1:
                yield ahead.popleft().result()
        while ahead:
            yield ahead.popleft().result()
