"""The stored state of a scene: bodies, joints and attachments come back where they last stood."""

import os
from pathlib import Path

import pytest

from semmap.nodes.sim_node.models.sources import Models
from semmap.nodes.sim_node.scene_state import SceneStore
from semmap.nodes.sim_node.world import World
from semmap.nodes.sim_node.world_file import open_world
from semmap.schemas.scenes import GripOrder, JointOrder
from tests.sim_node.orders import bodies, hand, pose

WORLD = """<mujoco><compiler angle="radian"/><worldbody><geom type="plane" size="5 5 .1"/>
<body name="table_1"><geom type="box" size=".4 .6 .02" pos="0 0 .73"/></body>
<body name="cup 1" pos="0 0 .8"><freejoint/><geom type="cylinder" size=".04 .05"/></body>
<body name="tray_1" pos="0 .3 .76"><freejoint/><geom type="box" size=".1 .1 .01"/></body>
<body name="box_1" pos="0 2 {}"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
<body name="cabinet_1" pos="2 0 0"><geom type="box" size=".3 .3 .4" pos="0 0 .4"/>
 <body name="leaf" pos=".32 .3 .4"><joint name="hinge" axis="0 0 -1" range="0 1.57" damping="1"/>
  <geom type="box" size=".01 .3 .4" pos="0 -.3 0"/></body>
 <body name="panel" pos="0 -.32 .4"><joint name="knob" axis="0 1 0" range="0 1.5" damping=".1"/>
  <geom type="cylinder" size=".03 .01"/></body>
 <body name="globe" pos="0 0 1"><joint name="ball" type="ball" damping="1"/><geom size=".1"/></body></body>
</worldbody></mujoco>"""
TABLE = (
    '{"entities": [{"class": "Table", "name": "table1", "at": [1, 2, 0]}, {"class": "Cup", "name": "cup1"}]}'
)


class Runs:
    """Runs of a simulator, one after the other, with one world file and one stored state."""

    def __init__(self, folder: Path, name: str = "world.xml", content: str = WORLD.format(0.1)) -> None:
        self.path, self.file = folder / name, folder / "stored"
        self.path.write_text(content)

    def start(self) -> tuple[World, tuple[str, ...]]:
        """Open the world as the simulator does, and return it with the notes."""
        world = open_world(self.path, Models())
        self.store = SceneStore(self.file, world, self.path)
        return world, self.store.restore()


@pytest.fixture
def runs(tmp_path) -> Runs:
    return Runs(tmp_path)


def rest(world: World) -> None:
    for _ in range(400):
        world.step(0.05)
        if all(world.poses().resting):
            return
    raise AssertionError("the bodies do not come to rest")


def live_a_day(world: World) -> None:
    """Move a cup, a box and the table, attach, open, switch and turn."""
    rest(world)
    world.move([hand("box_1", pose(1.0, 1.0)), hand("table_1", pose(-2.0, 0.0))])
    world.move([hand("cup_1", pose(-2.0, 0.2, 0.76)), hand("tray_1", pose(-2.0, -0.2, 0.76))])
    rest(world)
    world.grip([GripOrder(name="cup_1", holder="tray_1")])
    world.move_joints([JointOrder(name="cabinet_1", positions={"hinge": 1.2, "knob": 1.0})])
    world.data.qpos[world.model.joint("ball").qposadr[0] :][:4] = (0.8, 0.6, 0.0, 0.0)
    rest(world)


def stand(world: World) -> dict[str, tuple[float, ...]]:
    """Return pose and joints of each body, rounded."""
    return {
        name: (*body.pose.position_m, *body.pose.orientation_wxyz, *(joint.position for joint in body.joints))
        for name, body in bodies(world).items()
    }


def test_all_come_back_where_they_last_stood(runs):
    world, notes = runs.start()
    assert notes == ()
    live_a_day(world)
    runs.store.update(world.poses())
    stood = stand(world)
    assert stood["box_1"][:2] == pytest.approx((1.0, 1.0), abs=0.01)

    again, notes = runs.start()
    assert notes == ()
    for name, state in stand(again).items():
        assert state == pytest.approx(stood[name], abs=1e-6), name
    assert bodies(again)["cup_1"].held_by == "tray_1"
    rest(again)
    for name, state in stand(again).items():
        assert state == pytest.approx(stood[name], abs=5e-3), name
    again.move([hand("tray_1", pose(3.0, 3.0))])
    assert bodies(again)["cup_1"].pose.position_m[:2] == pytest.approx((3.0, 3.4), abs=0.02)


def test_a_body_whose_place_in_the_file_has_changed_begins_there(runs):
    world, _ = runs.start()
    live_a_day(world)
    runs.store.write()
    runs.path.write_text(
        WORLD.format(1.1).replace("box_1", "crate_1").replace('pos="0 .3 .76"', 'pos="0 .4 .76"')
    )
    again, notes = runs.start()
    assert notes == (
        "world.xml has changed: crate_1 and tray_1 begin as in the file;"
        " the others stand where they last stood; to reset all: --reset-world",
    )
    stood = stand(again)
    assert stood["crate_1"][:3] == pytest.approx((0.0, 2.0, 1.0), abs=1e-6)
    assert stood["tray_1"][:3] == pytest.approx((0.0, 0.4, 0.75), abs=1e-6)
    assert stood["table_1"][0] == pytest.approx(-2.0)


def test_a_change_that_moves_nothing_is_told(runs):
    world, _ = runs.start()
    live_a_day(world)
    runs.store.write()
    runs.path.write_text(runs.path.read_text() + "<!-- -->")
    again, (note,) = runs.start()
    assert note.startswith("world.xml has changed: all bodies stand where they last stood")
    assert stand(again)["box_1"] == pytest.approx(stand(world)["box_1"], abs=1e-6)


def test_the_state_of_another_world_and_a_damaged_one_are_not_used(runs, tmp_path):
    world, _ = runs.start()
    live_a_day(world)
    runs.store.write()
    other = Runs(tmp_path, "other.xml")
    assert other.start()[1] == ("another world than before (world.xml); other.xml begins as in its file",)
    runs.file.write_bytes(b"\x01\x02")
    again, notes = runs.start()
    assert notes == ("stored cannot be read, so world.xml begins as in its file",)
    assert stand(again)["box_1"][:2] == pytest.approx((0.0, 2.0))


def test_the_furniture_of_a_scene_in_json_comes_back(tmp_path):
    runs = Runs(tmp_path, "scene.json", TABLE)
    world, _ = runs.start()
    world.move([hand("table1", pose(-1.0, 0.0)), hand("cup1", pose(3.0, 0.0))])
    rest(world)
    runs.store.update(world.poses())
    again, notes = runs.start()
    assert notes == ()
    assert stand(again)["table1"] == pytest.approx(stand(world)["table1"], abs=1e-6)
    assert stand(again)["cup1"] == pytest.approx(stand(world)["cup1"], abs=1e-6)


def test_the_state_is_written_when_a_body_comes_to_rest_and_not_while_all_sleep(runs):
    world, _ = runs.start()
    rest(world)
    runs.store.update(world.poses())
    world.move([hand("box_1", pose(1.0, 1.0, 0.02))])
    runs.store.update(world.poses())
    written = runs.file.read_bytes()
    rest(world)
    runs.store.update(world.poses())
    assert runs.file.read_bytes() != written
    while not world.asleep:
        world.step(0.05)
    runs.store.update(world.poses())
    runs.file.unlink()
    runs.store.update(world.poses())
    assert not runs.file.exists()


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_cannot_be_written_is_logged(runs, caplog):
    runs.start()
    runs.path.parent.chmod(0o500)
    try:
        runs.store.write()
    finally:
        runs.path.parent.chmod(0o700)
    assert "cannot be written: Permission denied" in caplog.text
