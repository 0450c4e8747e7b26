"""Floor plans in files of the ROS map server."""

from __future__ import annotations

import pytest

from semmap.nodes.extern.floorplans import read_plan
from semmap.schemas import errors
from tests.runtime.test_pictures import png_of


@pytest.mark.parametrize("suffix", ["png", "pgm"])
@pytest.mark.parametrize(("width", "height"), [(5000, 5000), (30_000, 30_000), (2**31 - 1, 2**31 - 1)])
def test_a_plan_with_too_many_pixels_is_rejected_in_one_line(tmp_path, suffix, width, height):
    plan, image = tmp_path / "plan.yaml", tmp_path / f"plan.{suffix}"
    plan.write_text(f"image: {image.name}\nresolution: 0.05\norigin: [0, 0, 0]\n")
    pgm = b"P5\n%d %d\n255\n" % (width, height)
    image.write_bytes(png_of(width, height) if suffix == "png" else pgm)
    with pytest.raises(errors.BadFile, match=r"16,000,000") as rejected:
        read_plan(plan)
    assert "\n" not in rejected.value.text
