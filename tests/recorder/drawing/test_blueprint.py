from collections.abc import Iterator

import pytest
import rerun.blueprint as rrb

from semmap.nodes.recorder.drawing.blueprint import Bounds, bounds_of, layout
from tests.recorder.messages import pose


def views(part: rrb.Container | rrb.View) -> Iterator[rrb.View]:
    """Return all views of a layout."""
    if isinstance(part, rrb.View):
        yield part
        return
    for inner in part.contents:
        yield from views(inner)


def test_the_eye_looks_at_the_middle_of_what_there_is_from_near_enough():
    assert bounds_of([]) == Bounds()
    assert bounds_of([pose(1.0, 2.0, 0.5)]).extent_m < 4.0
    wide = bounds_of([pose(-4.0, 1.0, 0.0), pose(8.0, 3.0, 1.0)])
    assert wide.centre_m == pytest.approx((2.0, 2.0, 0.5))
    assert wide.extent_m == pytest.approx(12.0)
    rooms = [pose(x, y, 0.0) for x in (0.0, 4.0, 8.0) for y in (0.0, 3.0)]
    assert bounds_of([*rooms, pose(2000.0, 0.0, 0.0)]) == bounds_of(rooms)


def test_each_camera_has_its_picture_with_the_boxes_seen_but_not_too_many():
    cameras = [f"camera{n}" for n in range(10)]
    assert not any(isinstance(view, rrb.Spatial2DView) for view in views(layout(Bounds()).root_container))
    shown = [
        view
        for view in views(layout(Bounds(), cameras).root_container)
        if isinstance(view, rrb.Spatial2DView)
    ]
    assert [view.name for view in shown] == cameras[: len(shown)]
    assert 1 < len(shown) < 5
    assert shown[0].origin == "map/perception/cameras/camera0"
    assert shown[0].contents == ["/map/perception/cameras/camera0", "/map/perception/boxes"]
