import pytest

from nodes.kb_node.storage.journal.pace import Pace


def test_before_anything_was_written_nothing_is_known():
    assert not Pace().is_slow()


@pytest.mark.parametrize(
    ("times_s", "slow"), [([3e-4] * 5 + [1e-5] * 4, True), ([1e-5] * 5 + [2.0] * 4, False)]
)
def test_the_median_counts(times_s, slow):
    pace = Pace()
    for time_s in times_s:
        pace.took(time_s)
    assert pace.is_slow() == slow


def test_a_disk_that_becomes_quick_is_noticed():
    pace = Pace()
    for _ in range(9):
        pace.took(3e-4)
    asked = [pace.is_slow() for _ in range(100)]
    assert asked.count(False) == 3
    for _ in range(9):
        pace.took(1e-5)
    assert not any(pace.is_slow() for _ in range(100))
