"""Work on other threads: fair and bounded."""

from __future__ import annotations

import threading

import pytest

from semmap.nodes.runtime.fair_pool import FairPool
from semmap.schemas import errors
from tests.conftest import until


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
