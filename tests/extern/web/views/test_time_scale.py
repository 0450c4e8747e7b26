import pytest

from semmap.nodes.extern.web.views.time_scale import STEPS, index_at, positions_of


@pytest.mark.parametrize(
    ("stamps", "positions"),
    [
        ([], []),
        ([5], [STEPS]),
        ([5, 5], [STEPS, STEPS]),
        ([100, 150, 200], [0, 500, 1000]),
        ([100, 101, 1100], [0, 1, 1000]),
        ([100, 300, 200, 500], [0, 500, 500, 1000]),  # the clock was set back
    ],
)
def test_positions_are_proportional_to_time(stamps, positions):
    assert positions_of(stamps) == positions


@pytest.mark.parametrize(("position", "index"), [(0, 0), (1, 0), (499, 0), (500, 2), (999, 2), (1000, 3)])
def test_a_position_shows_the_last_commit_until_then(position, index):
    assert index_at([0, 500, 500, 1000], position) == index


def test_a_position_before_the_first_commit_shows_the_first():
    assert index_at([STEPS], 10) == 0
    assert index_at([], 10) == 0
