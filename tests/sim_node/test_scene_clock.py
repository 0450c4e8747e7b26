"""A clock that is set hides no poses."""

from dataclasses import dataclass

from semmap.nodes.coordinator.scene.scene_view import SceneView
from semmap.nodes.sim_node.scene_clock import SceneClock
from semmap.nodes.sim_node.world import World

SECOND_NS = 10**9


@dataclass
class Clock:
    now_ns: int = 1000 * SECOND_NS

    def __call__(self):
        return self.now_ns


def test_stamps_rise_when_the_clock_is_set_back_a_little_and_follow_it_otherwise():
    clock = Clock()
    stamps = SceneClock(clock)
    seen = [stamps.stamp_ns(), stamps.stamp_ns()]
    clock.now_ns -= 3 * SECOND_NS
    seen += [stamps.stamp_ns(), stamps.stamp_ns()]
    assert seen == sorted(set(seen))
    assert seen[-1] - seen[0] < SECOND_NS
    clock.now_ns += 5 * SECOND_NS
    assert stamps.stamp_ns() == clock.now_ns
    clock.now_ns -= 3600 * SECOND_NS
    assert stamps.stamp_ns() == clock.now_ns


def test_subscribers_follow_the_scene_over_each_step_of_the_clock():
    clock, view = Clock(), SceneView()
    world = World(clock=SceneClock(clock))
    view.take(world.scene())
    for step_s in (-3, 3, -9, 9, -3600, 3600):
        clock.now_ns += step_s * SECOND_NS
        if view.update(world.poses()) is None:
            view.take(world.scene())
        clock.now_ns += SECOND_NS // 20
        before_ns = view.stamp_ns
        assert view.update(world.poses()) == set()
        assert view.stamp_ns != before_ns
