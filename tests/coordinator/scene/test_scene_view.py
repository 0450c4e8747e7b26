from semmap.nodes.coordinator.scene.scene_view import SceneView
from semmap.schemas.entities import Pose
from semmap.schemas.scenes import Body, Poses, Scene

HOUR_NS = 3_600_000_000_000


def body(name: str) -> Body:
    return Body(
        name=name,
        class_="Cup",
        model="cup",
        pose=Pose(position_m=(0.0, 0.0, 0.0)),
        size_m=(0.1, 0.1, 0.1),
        fixed=False,
        entity=True,
        ghost=False,
        resting=True,
        commit=1,
        shape_commit=1,
    )


def poses(stamp_ns: int, resting: tuple[bool, bool], *, run: str = "r", version: int = 1) -> Poses:
    return Poses(
        run=run,
        version=version,
        stamp_ns=stamp_ns,
        sim_time_s=0.0,
        names=("a", "b"),
        poses=(0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0),
        resting=resting,
        commits=(1, 1),
    )


def seen() -> SceneView:
    view = SceneView()
    view.take(
        Scene(run="r", version=1, stamp_ns=10, sim_time_s=0.0, world="w", bodies=(body("a"), body("b")))
    )
    return view


def test_it_returns_the_changed_bodies():
    view = seen()
    assert view.update(poses(11, (True, True))) == set()
    assert view.update(poses(12, (True, False))) == {"b"}
    assert view.bodies["b"].pose.position_m == (2.0, 0.0, 0.0)
    assert view.update(poses(13, (True, True))) == {"b"}  # it came to rest
    assert view.update(poses(14, (True, True))) == set()


def test_older_poses_are_ignored():
    assert seen().update(poses(9, (False, False))) == set()
    assert seen().update(poses(9, (False, False), version=0)) == set()


def test_added_or_removed_bodies_need_a_snapshot():
    assert seen().update(poses(11, (True, True), version=2)) is None
    assert seen().update(poses(9, (True, True), run="another")) is None


def test_poses_of_another_clock_need_a_snapshot():
    view = seen()
    assert view.update(poses(2**62, (False, False))) is None
    assert view.update(poses(20, (False, True))) == {"a"}


def test_a_clock_that_was_set_back_does_not_stop_the_poses():
    day_ns = 86_400 * 10**9
    view = SceneView()
    view.take(
        Scene(run="r", version=1, stamp_ns=day_ns, sim_time_s=0.0, world="w", bodies=(body("a"), body("b")))
    )
    assert view.update(poses(10, (False, True))) is None
    view.take(
        Scene(run="r", version=1, stamp_ns=15, sim_time_s=0.0, world="w", bodies=(body("a"), body("b")))
    )
    assert view.update(poses(20, (False, True))) == {"a"}


def test_it_has_the_run_and_the_stamp_of_the_newest_poses():
    view = seen()
    assert (view.known, view.run, view.stamp_ns) == (True, "r", 10)
    view.update(poses(12, (True, True)))
    assert (view.run, view.stamp_ns) == ("r", 12)


def test_nothing_is_left_of_a_simulator_that_has_ended():
    view = seen()
    view.forget()
    assert (view.known, view.bodies, view.run, view.stamp_ns, view.sim_time_s) == (False, {}, "", 0, 0.0)
    view.take(Scene(run="r", version=1, stamp_ns=5, sim_time_s=0.0, world="w", bodies=(body("a"),)))
    assert list(view.bodies) == ["a"]  # though it is older than what was forgotten


def test_an_older_snapshot_is_ignored_and_one_after_the_clock_was_set_is_taken():
    def taken(stamp_ns: int) -> list[str]:
        view = SceneView()
        for version, at_ns, name in ((1, HOUR_NS, "a"), (2, stamp_ns, "b")):
            there = (body(name),)
            view.take(
                Scene(run="r", version=version, stamp_ns=at_ns, sim_time_s=0.0, world="w", bodies=there)
            )
        return list(view.bodies)

    assert taken(HOUR_NS - 1) == ["a"]
    assert taken(HOUR_NS + 1) == ["b"]
    assert taken(0) == ["b"]


def test_a_body_that_was_created_since_is_added():
    view = seen()
    view.add((body("c"),))
    assert list(view.bodies) == ["a", "b", "c"]
