import gc

import pytest

from semmap.nodes.runtime import memory


@pytest.fixture(autouse=True)
def unfrozen():
    gc.unfreeze()
    yield
    gc.enable()
    gc.unfreeze()


def test_nothing_is_collected_during_the_pause():
    with memory.uncollected():
        assert not gc.isenabled()
        with memory.uncollected():
            pass
        assert not gc.isenabled()
    assert gc.isenabled()


def test_it_is_collected_again_after_an_error():
    with pytest.raises(ZeroDivisionError), memory.uncollected():
        raise ZeroDivisionError
    assert gc.isenabled()


def test_many_new_objects_are_frozen_and_few_on_request():
    with memory.uncollected():
        few = [[] for _ in range(10)]
    assert gc.get_freeze_count() == 0
    with memory.uncollected():
        many = [[] for _ in range(memory._MANY + 1)]
    assert gc.get_freeze_count() > len(many)
    gc.unfreeze()
    with memory.uncollected(freeze=True):
        pass
    assert gc.get_freeze_count() > len(few)
