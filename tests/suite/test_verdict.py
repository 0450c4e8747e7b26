"""A run is green if all passed, or a few tests that need processes did when they were run again, alone."""

import pytest

from tests.suite.failures import Failure
from tests.suite.verdict import Verdict, judge


def _failures(*names, needs_process=True):
    return [Failure(name, needs_process, "") for name in names]


def test_a_run_without_failures_is_green_and_prints_nothing():
    verdict = judge([], lambda name: pytest.fail(name))
    assert verdict.is_green
    assert verdict.lines() == []


def test_a_test_that_passes_alone_is_flaky_and_its_name_is_printed():
    verdict = judge(_failures("a", "b"), lambda name: True)
    assert verdict.is_green
    assert verdict.lines() == ["flaky: a", "flaky: b"]


def test_a_test_that_fails_again_is_a_failure():
    verdict = judge(_failures("a", "b"), lambda name: name == "a")
    assert verdict == Verdict(failed=("b",), flaky=("a",))
    assert not verdict.is_green


def test_more_than_two_flaky_tests_are_a_failure():
    verdict = judge(_failures("a", "b", "c"), lambda name: True)
    assert not verdict.is_green
    assert verdict.lines()[:3] == ["flaky: a", "flaky: b", "flaky: c"]


def test_a_test_that_needs_no_process_is_never_run_again():
    failures = [*_failures("a"), *_failures("b", needs_process=False)]
    verdict = judge(failures, lambda name: pytest.fail(name))
    assert verdict == Verdict(failed=("a", "b"))


def test_where_very_many_failed_none_is_run_again():
    verdict = judge(_failures(*"abcdefghijk"), lambda name: pytest.fail(name))
    assert not verdict.is_green
    assert verdict.flaky == ()
