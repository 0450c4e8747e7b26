import pytest
import trimesh

from semmap.nodes.sim_node.models.library import ModelError
from semmap.nodes.sim_node.models.parts import Role, Shape
from semmap.nodes.sim_node.models.sources import Models
from semmap.nodes.sim_node.world import World
from tests.sim_node.orders import order, pose

MJCF = """
<mujoco>
  <asset><mesh name="roof" vertex="0 0 0  1 0 0  0 1 0  0 0 1" scale="0.2 0.2 0.2"/></asset>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body pos="0 0 0.1">
      <geom type="box" size="0.1 0.2 0.1" rgba="1 0 0 1"/>
      <body pos="0 0 0.2"><joint type="hinge"/><geom type="sphere" size="0.1" contype="0"
        conaffinity="0"/></body>
      <geom type="mesh" mesh="roof" pos="0 0 0.1"/>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture
def folder(tmp_path):
    box = trimesh.creation.box(extents=(0.4, 0.2, 0.1))
    box.export(tmp_path / "brick.stl")
    box.export(tmp_path / "brick2.obj")
    trimesh.Scene(box).export(tmp_path / "chair.glb")
    (tmp_path / "toy.xml").write_text(MJCF)
    open_mesh = trimesh.creation.icosphere(radius=0.2)
    open_mesh.update_faces(range(len(open_mesh.faces) // 2))
    open_mesh.export(tmp_path / "open.stl")
    (tmp_path / "round.xml").write_text(
        """<mujoco><worldbody><body>
          <geom type="sphere" size="0.1" pos="0 0 0.5" mass="1"/>
          <geom type="cylinder" size="0.2 0.05" mass="2"/>
          <geom type="capsule" size="0.05 0.2" pos="0 0 0.25" mass="0.5"/>
        </body></worldbody></mujoco>"""
    )
    (tmp_path / "light.xml").write_text(
        "<mujoco><worldbody><body><geom size='0.1' mass='0'/></body></worldbody></mujoco>"
    )
    (tmp_path / "flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "strange.obj").write_text(
        "v nan 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 1 3 4"
    )
    (tmp_path / "broken.xml").write_text("<mujoco><worldbody><geom type='blob'/></worldbody></mujoco>")
    (tmp_path / "broken.stl").write_bytes(b"solid nothing")
    (tmp_path / "broken.obj").write_text("f 1 2 3")
    (tmp_path / "empty.xml").write_text("<mujoco/>")
    trimesh.creation.box(extents=(4000, 1, 1)).export(tmp_path / "huge.stl")
    return tmp_path


def test_meshes_are_read_in_metres_and_stretched(folder):
    models = Models(folder)
    assert models("brick.stl", None).size_m == pytest.approx((0.4, 0.2, 0.1))
    assert models("brick2", None).size_m == pytest.approx((0.4, 0.2, 0.1))
    assert models("brick2", (1.0, 1.0, 2.0)).size_m == pytest.approx((1.0, 1.0, 2.0))


def test_gltf_is_turned_so_that_z_is_up(folder):
    assert Models(folder)("chair", None).size_m == pytest.approx((0.4, 0.1, 0.2))


def test_a_file_takes_the_place_of_a_built_in_model(folder):
    assert Models(folder)("chair", None).name.endswith("chair.glb")
    assert Models(folder)("table", None).name == "table"
    assert Models()("chair", None).name == "chair"


def test_mjcf_brings_its_bodies_and_their_joints(folder):
    toy = Models(folder)("toy", None)
    (leaf,) = toy.leaves
    assert (leaf.joint.name, leaf.joint.range, leaf.joint.closed) == ("joint", None, None)
    assert [part.role for part in leaf.parts] == [Role.VISUAL]
    assert [part.role for part in toy.parts] == [Role.BOTH, Role.BOTH, Role.VISUAL]
    assert toy.size_m == pytest.approx((0.3, 0.4, 0.4), abs=0.001)
    assert toy.parts[0].colour == (1.0, 0.0, 0.0)


def test_what_is_round_in_mjcf_stays_so_and_weighs_what_it_says(folder):
    round_ = Models(folder)("round", None)
    assert [part.shape for part in round_.parts] == [Shape.ELLIPSOID, Shape.CYLINDER, Shape.CAPSULE]
    assert [part.half for part in round_.parts] == [(0.1, 0.1, 0.1), (0.2, 0.2, 0.05), (0.05, 0.05, 0.2)]
    assert round_.size_m == pytest.approx((0.4, 0.4, 0.65))
    assert round_.inertial.mass_kg == pytest.approx(3.5)
    twice = Models(folder)("round", (0.8, 0.8, 1.3))
    assert twice.inertial.mass_kg == pytest.approx(8 * 3.5)


def test_primitives_of_mjcf_are_stretched_to_a_size(folder):
    (folder / "table.xml").write_text(
        """<mujoco><worldbody><body>
          <geom type="box" size="0.5 0.5 0.02" pos="0 0 0.98"/>
          <geom type="cylinder" size="0.05 0.48" pos="0 0 0.5"/>
          <geom type="box" size="0.1 0.4 0.01" euler="0 0 90" pos="0 0 0.01"/>
        </body></worldbody></mujoco>"""
    )
    table = Models(folder)("table", (2.0, 1.0, 0.5))
    top, leg, foot = table.parts
    assert table.size_m == pytest.approx((2.0, 1.0, 0.5))
    assert top.half == pytest.approx((1.0, 0.5, 0.01))
    assert top.centre == pytest.approx((0.0, 0.0, 0.49))
    assert leg.half == pytest.approx((0.05 * 2**0.5, 0.05 * 2**0.5, 0.24))
    assert foot.half == pytest.approx((0.1, 0.8, 0.005))


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("broken.xml", "blob"),
        ("broken.stl", "no colliding geometry"),
        ("broken.obj", "cannot use"),
        ("empty.xml", "no colliding geometry"),
        ("none.glb", "No such file"),
        ("huge.stl", "0.001 to 100 m along each axis, not 4000 m; is the file in metres"),
        ("strange.obj", "strange.obj: at least 4 vertices required$"),
        ("flat.obj", "0.001 to 100 m along each axis, not 0 m"),
        ("light.xml", "its mass is zero"),
    ],
)
def test_a_bad_file_is_told(folder, name, why):
    with pytest.raises(ModelError, match=why) as told:
        Models(folder)(name, None)
    assert name in str(told.value)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("name", ["broken.stl", "empty.xml", "flat.obj", "light.xml"])
def test_no_size_makes_a_bad_file_good(folder, name):
    with pytest.raises(ModelError, match=f"cannot use model file .*{name}: (it|a size)"):
        Models(folder)(name, (1.0, 1.0, 1.0))


def test_a_file_without_a_folder_says_where_it_belongs():
    with pytest.raises(
        ModelError, match=r"vacuum.obj is searched in the folder given by `semmap up --models DIR`"
    ):
        Models(None)("vacuum.obj", None)


def test_bodies_from_files_stand_beside_others(folder):
    world = World(models=Models(folder))
    spawned = world.spawn(
        [
            order("a", str(folder / "brick.stl"), pose(0, 0)),
            order("b", "brick2", pose(1, 0), size_m=(0.2, 0.2, 0.5)),
            order("c", "toy", pose(2, 0)),
            order("d", "open", pose(3, 0)),
            order("e", "broken.xml", pose(4, 0)),
            order("f", "chair", pose(5, 0)),
        ]
    )
    assert set(spawned.failed) == {"e"}
    assert "broken.xml" in spawned.failed["e"]
    world.step(1.0)
    heights = {b.name: b.pose.position_m[2] for b in world.scene().bodies}
    assert heights["a"] == pytest.approx(0, abs=0.002)
    assert heights["f"] == pytest.approx(0, abs=0.002)
    world.delete([*"abcdf"])
    assert world.scene().bodies == ()


def test_a_mesh_without_a_colour_that_can_be_read_is_grey(folder, monkeypatch):
    def unreadable(self):
        raise ValueError("no texture")

    monkeypatch.setattr(trimesh.visual.ColorVisuals, "main_color", property(unreadable))
    (part,) = Models(folder)("brick", None).parts
    assert max(part.colour) - min(part.colour) < 0.1
    assert all(0.2 < channel < 0.9 for channel in part.colour)
