"""The queue is bounded, and clients take turns."""

from __future__ import annotations

import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.runtime.fair_queue import LATEST_S, SOONEST_S, FairPool, FairQueue
from semmap.schemas import errors
from tests.conftest import until


def taken(queue):
    return [*iter(queue.take, None)]


def test_clients_take_turns_and_keep_their_own_order():
    queue = FairQueue()
    for asker, item in (("a", "a1"), ("a", "a2"), ("a", "a3"), ("b", "b1"), ("c", "c1"), ("b", "b2")):
        assert queue.put(asker, item) is None
    assert taken(queue) == ["a1", "b1", "c1", "a2", "b2", "a3"]
    assert len(queue) == 0


def test_urgent_items_come_first_or_alone_on_request():
    queue = FairQueue()
    queue.put("a", "late")
    queue.put("a", "soon", urgent=True)
    assert queue.take(urgent_only=True) == "soon"
    assert queue.take(urgent_only=True) is None
    assert queue.take() == "late"


def test_one_client_fills_its_own_queue_only():
    queue = FairQueue(each=2)
    assert queue.put("a", "a1") is None
    assert queue.put("a", "a2") is None
    again_s = queue.put("a", "a3")
    assert again_s is not None
    assert SOONEST_S <= again_s <= LATEST_S
    assert queue.put("b", "b1") is None
    assert taken(queue) == ["a1", "b1", "a2"]
    assert queue.put("a", "a4") is None


@pytest.mark.parametrize("limit", [{"everyone": 2}, {"size": 20}])
def test_all_together_are_bounded(limit):
    queue = FairQueue(**limit)
    assert queue.put("a", "a1", size=10) is None
    assert queue.put("b", "b1", size=10) is None
    assert queue.put("c", "c1", size=10) is not None
    queue.take()
    assert queue.put("c", "c1", size=10) is None


def test_one_that_is_larger_than_the_queue_comes_in_alone():
    queue = FairQueue(size=20)
    assert queue.put("a", "large", size=100) is None
    assert queue.put("b", "small", size=1) is not None
    assert queue.take() == "large"
    assert queue.put("b", "small", size=1) is None


@given(st.lists(st.one_of(st.none(), st.tuples(st.sampled_from("abc"), st.integers(0, 9)))))
def test_every_item_is_returned_once(steps):
    queue, came, went = FairQueue(each=4, everyone=6, size=30), [], []
    for number, step in enumerate(steps):
        if step is None:
            went += filter(None, [queue.take()])
        elif queue.put(step[0], (step[0], number), size=step[1]) is None:
            came.append((step[0], number))
    went += taken(queue)
    assert sorted(went) == sorted(came)
    for asker in "abc":
        assert [item for item in went if item[0] == asker] == [item for item in came if item[0] == asker]


def test_clients_take_turns_and_errors_are_returned():
    asker, done, held = [""], [], threading.Event()
    pool = FairPool(1, lambda: asker[0])
    pool.submit(held.wait, 10)
    for name in ("a1", "a2", "a3", "b1"):
        asker[0] = name[0]
        last = pool.submit(done.append, name)
    held.set()
    with pytest.raises(ZeroDivisionError):
        pool.submit(lambda: 1 // 0).result(10)
    last.result(10)
    pool.submit(int).result(10)
    assert done.index("b1") <= 2
    pool.close()


def test_too_much_work_is_rejected():
    held = threading.Event()
    pool = FairPool(1)
    pool.submit(held.wait, 10)
    until(lambda: len(pool._queue) == 0, "that is in hand")
    for _ in range(64):
        pool.submit(held.wait, 10)
    with pytest.raises(errors.Busy, match="64 long requests are waiting"):
        pool.submit(held.wait, 10)
    held.set()
    pool.close()
