from semmap.nodes.coordinator.scene.scene_view import SceneView
from semmap.schemas.entities import Pose
from semmap.schemas.scenes import Body, Poses, Scene


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
