import gc

import pytest

from nodes.kb_node import garbage


@pytest.fixture(autouse=True)
def unfrozen():
    gc.unfreeze()
    yield
    gc.enable()
    gc.unfreeze()


def test_nothing_is_collected_meanwhile():
    with garbage.uncollected():
        assert not gc.isenabled()
        with garbage.uncollected():
            pass
        assert not gc.isenabled()
    assert gc.isenabled()


def test_it_is_collected_again_after_an_error():
    with pytest.raises(ZeroDivisionError), garbage.uncollected():
        raise ZeroDivisionError
    assert gc.isenabled()


def test_many_new_objects_are_frozen_and_few_if_it_is_said():
    with garbage.uncollected():
        few = [[] for _ in range(10)]
    assert gc.get_freeze_count() == 0
    with garbage.uncollected():
        many = [[] for _ in range(garbage._MANY + 1)]
    assert gc.get_freeze_count() > len(many)
    gc.unfreeze()
    with garbage.uncollected(freeze=True):
        pass
    assert gc.get_freeze_count() > len(few)
