"""Memory that a large file leaves in the coordinator."""

import gc
import weakref

from semmap.nodes.coordinator import node


def test_reference_cycles_with_large_files_are_freed():
    class RequestCoroutine:
        """Refers to itself, like a coroutine with callbacks."""

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
