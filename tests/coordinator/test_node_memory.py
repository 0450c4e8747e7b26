"""What a large file leaves behind in the coordinator."""

import gc
import weakref

from semmap.nodes.coordinator import node


def test_cycles_with_large_files_are_parted_with():
    class RequestCoroutine:
        """Refers to itself, as one that goes on by callbacks does."""

    coroutine = RequestCoroutine()
    coroutine.itself = coroutine
    seen = weakref.ref(coroutine)
    gc.disable()
    try:
        del coroutine
        assert seen() is not None
        node._release_memory()
        assert seen() is None
    finally:
        gc.enable()
        gc.unfreeze()
