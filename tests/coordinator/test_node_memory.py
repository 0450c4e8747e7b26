"""What a large file leaves behind in the coordinator."""

import gc
import weakref

from semmap.nodes.coordinator import node


def test_cycles_with_large_files_are_parted_with():
    class Dialogue:
        """Refers to itself, as one that goes on by callbacks does."""

    dialogue = Dialogue()
    dialogue.itself = dialogue
    seen = weakref.ref(dialogue)
    gc.disable()
    try:
        del dialogue
        assert seen() is not None
        node._tidy()
        assert seen() is None
    finally:
        gc.enable()
        gc.unfreeze()
