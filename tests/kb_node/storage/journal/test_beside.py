import threading

import pytest

from nodes.kb_node.storage.journal.beside import Beside


@pytest.fixture
def beside():
    found = Beside()
    yield found
    found.close()


def test_work_is_done_by_another_thread_and_has_ended_when_the_block_has(beside):
    by, goes_on = [], threading.Event()

    def work():
        assert goes_on.wait(10.0)
        by.append(threading.get_ident())

    for _ in range(3):
        with beside.doing(work):
            assert by == []
            goes_on.set()
        assert by.pop() != threading.get_ident()
        goes_on.clear()


def test_what_the_work_raises_comes_at_the_end_and_the_thread_goes_on(beside):
    def fail():
        raise ValueError("work")

    reached = []
    with pytest.raises(ValueError, match="work"), beside.doing(fail):
        reached.append(1)
    assert reached == [1]
    with beside.doing(lambda: reached.append(2)):
        pass
    assert reached == [1, 2]


def test_what_the_block_raises_comes_first_and_the_work_is_done(beside):
    done = []

    def fail_late():
        done.append(1)
        raise ValueError("work")

    with pytest.raises(KeyError), beside.doing(fail_late):
        raise KeyError
    assert done == [1]
    with beside.doing(lambda: done.append(2)):  # the error before is not this one's
        pass
    assert done == [1, 2]


def test_the_thread_ends_with_its_owner():
    before = threading.active_count()
    beside = Beside()
    assert threading.active_count() == before
    with beside.doing(lambda: None):
        assert threading.active_count() == before + 1
    beside.close()
    assert threading.active_count() == before
    beside.close()
