from semmap.nodes.drawing.surfaces import SurfaceCache
from tests.recorder.messages import body, surface

SURFACE = surface()


def test_each_model_at_each_size_is_asked_for_once():
    cache = SurfaceCache()
    chairs = [body(f"chair{i}", model="chair") for i in range(3)]
    wanted = cache.wanted(chairs)
    assert list(wanted) == ["chair0"]
    assert cache.wanted(chairs) == {}
    assert cache.of(chairs[1]) is None
    cache.take(wanted["chair0"], SURFACE)
    assert cache.of(chairs[2]) is SURFACE
    assert cache.of(None) is None


def test_what_was_asked_for_in_vain_is_asked_for_again():
    cache = SurfaceCache()
    chair, table = body("chair1", model="chair"), body("table1", model="table")
    wanted = cache.wanted([chair, table])
    cache.take(wanted["table1"], SURFACE)
    cache.reset_requests(wanted.values())
    assert list(cache.wanted([chair, table])) == ["chair1"]
    assert cache.of(table) is SURFACE


def test_a_kind_whose_body_was_removed_before_the_reply_is_requested_with_another_body():
    cache = SurfaceCache()
    cups, box = [body("cup1", surface="a"), body("cup2", surface="a")], body("box1")
    kinds = cache.wanted([*cups, box])
    assert list(kinds) == ["cup1", "box1"]
    assert not cache.take_reply(kinds, {"unknown": SURFACE})
    kinds = cache.wanted([cups[1], box])
    assert list(kinds) == ["cup2"]
    assert cache.take_reply(kinds, {"cup2": SURFACE})
    assert cache.of(cups[0]) is SURFACE


def test_each_body_of_the_world_s_own_looks_like_itself():
    cache = SurfaceCache()
    robots = [body("robot1"), body("robot2")]
    wanted = cache.wanted(robots)
    assert list(wanted) == ["robot1", "robot2"]
    cache.take(wanted["robot1"], SURFACE)
    assert cache.of(robots[0]) is SURFACE
    assert cache.of(robots[1]) is None


def test_equal_bodies_of_the_world_share_a_surface_and_one_of_a_later_world_does_not():
    cache = SurfaceCache()
    cups = [body("cup1", surface="a"), body("cup2", surface="a")]
    wanted = cache.wanted(cups)
    assert list(wanted) == ["cup1"]
    cache.take(wanted["cup1"], SURFACE)
    assert cache.of(cups[1]) is SURFACE
    later = body("cup1", surface="b")
    assert cache.of(later) is None
    assert list(cache.wanted([later])) == ["cup1"]
