"""Reports on tests that were run many times."""

import pytest

from tests.suite.failures import Failure
from tests.suite.pytest_plugin import shuffle
from tests.suite.repeats import busy_loops, write_table


def test_a_test_is_listed_with_how_often_it_failed_and_its_first_message():
    failures = [Failure("a", True, "x"), Failure("b", True, "first"), Failure("b", True, "second")]
    assert write_table(failures, 10) == ["b  2 of 10  first", "a  1 of 10  x"]


def test_nothing_is_printed_when_all_passed():
    assert write_table([], 10) == []


def test_busy_loops_end_with_the_runs():
    with busy_loops(2) as loops:
        assert [loop.poll() for loop in loops] == [None, None]
    assert None not in [loop.poll() for loop in loops]


class _Item:
    def __init__(self, path, name):
        self.path, self.name = path, name


@pytest.fixture
def items():
    return [_Item(path, name) for path in "abcd" for name in "12345"]


def test_a_seed_gives_an_order_in_which_the_tests_of_a_file_stay_together(items):
    order = shuffle(items, 1)
    assert order == shuffle(items, 1)
    assert sorted(map(id, order)) == sorted(map(id, items))
    files = [order[start].path for start in range(0, 20, 5)]
    assert [item.path for item in order] == [path for path in files for _ in range(5)]
    orders = [shuffle(items, seed) for seed in range(5)]
    assert len({"".join(f"{item.path}{item.name}" for item in order) for order in orders}) == 5
