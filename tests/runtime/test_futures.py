"""Futures are resolved and chained."""

from __future__ import annotations

from concurrent.futures import Future, InvalidStateError

import pytest

from semmap.nodes.runtime.futures import SingleThreadFuture, settle, then

KINDS = pytest.mark.parametrize("kind", [Future, SingleThreadFuture])


def fail():
    raise ZeroDivisionError("oops")


@KINDS
def test_settling_takes_the_result_or_the_error(kind):
    done = kind()
    settle(done, lambda: 42)
    assert done.result() == 42
    broken = kind()
    settle(broken, fail)
    assert isinstance(broken.exception(), ZeroDivisionError)


@KINDS
def test_settling_with_a_future_waits_for_it(kind):
    inner, outer = kind(), kind()
    settle(outer, lambda: inner)
    assert not outer.done()
    inner.set_result(42)
    assert outer.result() == 42


@KINDS
def test_then_passes_results_and_errors_on(kind):
    first = kind()
    doubled = then(first, lambda x: 2 * x)
    assert type(doubled) is kind  # a future that other threads resolve is followed by one of the same kind
    first.set_result(21)
    assert doubled.result() == 42
    broken = then(doubled, lambda x: x / 0)
    assert isinstance(broken.exception(), ZeroDivisionError)
    assert then(broken, str).exception() is broken.exception()


def test_one_that_is_not_resolved_cannot_be_waited_for():
    future: SingleThreadFuture[int] = SingleThreadFuture()
    for read in (future.result, future.exception):
        with pytest.raises(InvalidStateError, match="cannot wait"):
            read()
    assert not any((future.done(), future.running(), future.cancel(), future.cancelled()))


def test_one_is_resolved_once():
    future: SingleThreadFuture[int] = SingleThreadFuture()
    future.set_result(42)
    with pytest.raises(InvalidStateError, match="already"):
        future.set_result(43)
    with pytest.raises(InvalidStateError, match="already"):
        future.set_exception(ZeroDivisionError())
    assert (future.done(), future.result(), future.exception()) == (True, 42, None)


def test_what_follows_is_called_in_order_and_goes_on_after_an_error(caplog):
    future: SingleThreadFuture[int] = SingleThreadFuture()
    seen = []
    future.add_done_callback(lambda done: seen.append(done.result()))
    future.add_done_callback(lambda _: fail())
    future.add_done_callback(lambda done: seen.append(-done.result()))
    assert not seen
    future.set_result(42)
    future.add_done_callback(lambda _: seen.append(0))
    assert seen == [42, -42, 0]
    assert "ZeroDivisionError" in caplog.text
