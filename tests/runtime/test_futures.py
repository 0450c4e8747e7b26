"""Futures that are resolved, and gone on from."""

from __future__ import annotations

from concurrent.futures import Future

from nodes.runtime.futures import settle, then


def fail():
    raise ZeroDivisionError("oops")


def test_settling_takes_the_result_or_the_error():
    done: Future = Future()
    settle(done, lambda: 42)
    assert done.result() == 42
    broken: Future = Future()
    settle(broken, fail)
    assert isinstance(broken.exception(), ZeroDivisionError)


def test_settling_with_a_future_waits_for_it():
    inner: Future = Future()
    outer: Future = Future()
    settle(outer, lambda: inner)
    assert not outer.done()
    inner.set_result(42)
    assert outer.result() == 42


def test_then_passes_results_and_errors_on():
    first: Future = Future()
    doubled = then(first, lambda x: 2 * x)
    first.set_result(21)
    assert doubled.result() == 42
    broken = then(doubled, lambda x: x / 0)
    assert isinstance(broken.exception(), ZeroDivisionError)
    assert then(broken, str).exception() is broken.exception()
