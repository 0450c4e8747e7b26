import math

import pytest

from semmap.nodes.extern.web.views.key_steps import KEYS, step_of


@pytest.mark.parametrize(
    ("heading_deg", "up"),
    [(90.0, 90.0), (60.0, 90.0), (0.0, 0.0), (-40.0, 0.0), (181.0, 180.0), (-90.0, -90.0)],
)
def test_up_is_away_from_the_viewer_along_an_axis(heading_deg, up):
    x, y = step_of("ArrowUp", math.radians(heading_deg))
    assert (x, y) == pytest.approx((0.1 * math.cos(math.radians(up)), 0.1 * math.sin(math.radians(up))))
    assert step_of("ArrowDown", math.radians(heading_deg)) == pytest.approx((-x, -y))
    assert step_of("ArrowRight", math.radians(heading_deg)) == pytest.approx((y, -x))


def test_shift_makes_steps_of_a_centimetre():
    assert len(KEYS) == 8
    for key in KEYS:
        assert math.hypot(*step_of(key, 1.0)) == pytest.approx(0.01 if "Shift" in key else 0.1)
