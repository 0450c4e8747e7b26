import pytest

from semmap.nodes.extern.ros.frames import Frames
from semmap.schemas import errors
from tests.extern.ros.made import transforms


def frames_of(*links, static=True, stamp_ns=0):
    found = Frames()
    found.take(transforms(*links, stamp_ns=stamp_ns), static=static)
    return found


def test_a_chain_of_frames_adds_up():
    found = frames_of(("base", "map", (1, 2, 0)), ("lens", "base", (0, 0, 1.5)))
    assert found.pose("lens", "map", 0)[:3, 3].tolist() == [1, 2, 1.5]
    assert found.pose("map", "map", 0).tolist() == [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]


def test_the_newest_counts():
    found = frames_of(("lens", "map", (1, 0, 0)))
    found.take(transforms(("lens", "map", (2, 0, 0))), static=True)
    assert found.pose("/lens", "map", 0)[0, 3] == 2


def test_an_unpublished_frame_is_named():
    with pytest.raises(errors.BadRequest, match="frame 'base' has no parent on /tf"):
        frames_of(("lens", "base", (0, 0, 0))).pose("lens", "map", 0)


def test_one_that_is_old_is_refused_unless_it_is_static():
    links, second_ns = ("lens", "map", (0, 0, 0)), 1_000_000_000
    assert frames_of(links).pose("lens", "map", 100 * second_ns) is not None
    found = frames_of(links, static=False, stamp_ns=5 * second_ns)
    assert found.pose("lens", "map", 5 * second_ns) is not None
    with pytest.raises(errors.BadRequest, match=r"'lens' on /tf is 2\.5 s old"):
        found.pose("lens", "map", 7_500_000_000)


def test_frames_in_one_another_are_refused():
    with pytest.raises(errors.BadRequest, match="form a cycle"):
        frames_of(("a", "b", (0, 0, 0)), ("b", "a", (0, 0, 0))).pose("a", "map", 0)


def test_invalid_transforms_are_ignored():
    said = transforms(("lens", "map", (float("nan"), 0, 0)), ("", "map", (0, 0, 0)), ("a", "a", (0, 0, 0)))
    found = Frames()
    found.take(said, static=True)
    for frame in ("lens", "a"):
        with pytest.raises(errors.BadRequest):
            found.pose(frame, "map", 0)
