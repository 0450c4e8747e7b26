import json
import struct

import numpy as np
import pytest

from semmap.nodes.runtime.class_names import ClassNames
from semmap.nodes.sim_node.models.sources import Models
from semmap.nodes.sim_node.physics import base_scene
from semmap.nodes.sim_node.vision.view import camera_names, camera_view
from semmap.nodes.sim_node.world_file import names_classes, open_world, require_world
from semmap.schemas.entities import ClassInfo
from semmap.schemas.errors import BadFile
from tests.household import household_classes

SCENE = {
    "entities": [{"class": "Chair", "name": "chair9", "at": [1, 2, 0]}, {"class": "Cup", "at": [0, 0, 0]}]
}


def test_a_scene_in_json_is_a_world_with_furniture_of_its_own(tmp_path):
    path = tmp_path / "world.json"
    path.write_text(json.dumps(SCENE))
    bodies = {body.name: body for body in open_world(path, Models()).scene().bodies}
    assert {name: body.class_ for name, body in bodies.items()} == {"chair9": "Chair", "cup1": "Cup"}
    assert not any(body.entity for body in bodies.values())
    assert bodies["chair9"].model == "chair"
    assert bodies["chair9"].pose.position_m[:2] == pytest.approx((1.0, 2.0))


def test_a_body_has_the_model_of_its_class_and_is_held_if_that_is_fixed(tmp_path):
    path = tmp_path / "world.json"
    described = [
        {"class": c, "at": [i, 0, 0]} for i, c in enumerate(("Milk", "dining_table", "Door", "Gizmo"))
    ]
    path.write_text(json.dumps({"entities": described}))
    rows = [
        row("Milk", "carton"),
        row("Dining_Table", "table"),
        row("Door", "door", fixed=True),
    ]
    bodies = open_world(path, Models(), classes=ClassNames(rows)).scene().bodies
    assert [(body.model, body.fixed) for body in bodies] == [
        *(("carton", False), ("table", False), ("door", True), ("box", False))
    ]
    path.write_text(json.dumps({"entities": [{"class": "Chair"}]}))
    (chair,) = open_world(path, Models(), classes=ClassNames(rows)).scene().bodies
    assert chair.model == "chair"  # for want of a better one: no class is called so


def row(name, model, *, fixed=False):
    """Return a class of things in space."""
    return ClassInfo(
        name=name, iri=f"x#{name}", parents=(), ancestors=(), labels={}, spatial=True, place=False,
        fixed=fixed, model=model,
    )  # fmt: skip


def test_its_camera_sees_all_of_it_from_near(tmp_path):
    path = tmp_path / "world.json"
    path.write_text(json.dumps(SCENE))
    world = open_world(path, Models())
    view = camera_view(world.model, world.data, "overview", 640, 480)
    for body in world.scene().bodies:
        column, row, depth_m = pixel_of(body.pose.position_m, view)
        assert 0 < column < 640
        assert 0 < row < 480
        assert depth_m < 5.0


def pixel_of(point, view):
    """Return column, row and depth [m] of a point in a view."""
    seen = np.linalg.inv(view.map_from_camera) @ (*point, 1.0)
    column, row, _ = view.intrinsics @ seen[:3] / seen[2]
    return column, row, seen[2]


def test_its_cameras_are_where_it_places_them(tmp_path):
    path = tmp_path / "world.json"
    right = (0.5, -0.5, 0.5, -0.5)  # of the optical frame of who looks along x: its z is the map's x
    cameras = [
        {"name": "desk", "at": [1, 0, 1.5], "look_at": [1, 2, 0.5], "fovy": 0.8},
        {"at": [0, 0, 1], "orientation": right},
        {"name": "camera_3", "at": [1, 2, 4], "look_at": [1, 2, 0]},
        {"at": [1, 2, 3], "look_at": [1, 2, 9]},
    ]
    path.write_text(json.dumps({**SCENE, "cameras": cameras}))
    world = open_world(path, Models())
    assert camera_names(world.model) == ("desk", "camera_2", "camera_3", "camera_4")
    desk, along_x, down, up = (
        camera_view(world.model, world.data, name, 640, 480) for name in camera_names(world.model)
    )
    assert desk.map_from_camera[:3, 3] == pytest.approx([1, 0, 1.5])
    assert pixel_of((1, 2, 0.5), desk) == pytest.approx((320, 240, np.sqrt(5)))
    assert pixel_of((1, 2, 0.7), desk)[1] < 240
    assert desk.fovy_rad == pytest.approx(0.8)
    assert pixel_of((2, 0, 1), along_x) == pytest.approx((320, 240, 2))
    assert pixel_of((2, -0.5, 1.2), along_x)[0] > 320 > 240 > pixel_of((2, -0.5, 1.2), along_x)[1]
    assert along_x.fovy_rad == pytest.approx(1.0)
    column, row, depth = pixel_of((1.1, 2.1, 0), down)
    assert (column > 320, row < 240, depth) == (True, True, pytest.approx(4))
    assert pixel_of((1, 2, 9), up) == pytest.approx((320, 240, 6))


def test_a_world_may_have_cameras_and_nothing_else_or_none_at_all(tmp_path):
    path = tmp_path / "world.json"
    path.write_text('{"entities": [], "cameras": [{"name": "a", "at": [0, 0, 1], "look_at": [1, 0, 0]}]}')
    assert camera_names(open_world(path, Models()).model) == ("a",)
    path.write_text('{"entities": [], "cameras": []}')
    assert camera_names(open_world(path, Models()).model) == ()


def test_a_byte_order_mark_is_no_part_of_a_world(tmp_path):
    path = tmp_path / "world.json"
    path.write_text(json.dumps(SCENE), encoding="utf-8-sig")
    assert len(open_world(path, Models())) == 2


@pytest.mark.parametrize(
    "content", ["", "{", "[]", '{"entities": [{"class": "Cup", "at": [0, 0]}]}', "<mujoco", "hello"]
)
def test_what_is_no_world_is_told(tmp_path, content):
    path = tmp_path / "world.json"
    path.write_text(content)
    with pytest.raises(BadFile, match=r"world\.json is not a valid scene: "):
        open_world(path, Models())


def test_a_missing_world_is_told(tmp_path):
    with pytest.raises(BadFile, match="cannot read"):
        open_world(tmp_path / "none.xml", Models())


@pytest.mark.parametrize("folder", ["", "textures"])
def test_a_texture_with_too_many_pixels_is_rejected_before_it_is_decoded(tmp_path, folder):
    (tmp_path / folder).mkdir(exist_ok=True)
    size = struct.pack(">4sII", b"IHDR", 30_000, 30_000)
    (tmp_path / folder / "huge.png").write_bytes(b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + size)
    path = tmp_path / "world.xml"
    compiler = f'<compiler texturedir="{folder}"/>' if folder else ""
    path.write_text(
        f'<mujoco>{compiler}<asset><texture name="t" type="2d" file="huge.png"/></asset></mujoco>'
    )
    with pytest.raises(BadFile, match=r"huge\.png: the image has 30000 x 30000 pixels; the maximum is"):
        open_world(path, Models())


def test_mjcf_that_refers_to_what_it_does_not_have_is_refused_as_it_is_read(tmp_path):
    """A copy of such a specification compiles, because it has lost the pair."""
    path = tmp_path / "world.xml"
    body = '<body name="a"><geom name="a" size="0.1"/></body>'
    pair = '<contact><pair geom1="a" geom2="b"/></contact>'
    path.write_text(f"<mujoco><worldbody>{body}</worldbody>{pair}</mujoco>")
    with pytest.raises(BadFile, match=r"cannot compile world file .*: Error: geom 'b' not found"):
        open_world(path, Models())


def test_a_world_that_is_too_large_for_mujocos_estimate_is_refused_with_what_helps(tmp_path, monkeypatch):
    """A world of 5 000 bodies, which takes seconds to fail."""

    class Large:
        @staticmethod
        def from_file(path):
            raise ValueError("Error: engine error: Could not allocate memory")

    monkeypatch.setattr(base_scene.mujoco, "MjSpec", Large)
    with pytest.raises(
        BadFile, match=r'Could not allocate memory; set the limit in the file: <size memory="200M"/>$'
    ):
        base_scene.read_mjcf(tmp_path / "world.xml")


def test_the_only_body_of_a_file_has_the_name_of_the_file(tmp_path):
    path = tmp_path / "blue_mug.xml"
    path.write_text("<mujoco><worldbody><body><freejoint/><geom size='.1'/></body></worldbody></mujoco>")
    (mug,) = open_world(path, Models(), classes=ClassNames(household_classes())).scene().bodies
    assert (mug.name, mug.class_, mug.label) == ("blue_mug", "Cup", "blue mug")


def test_the_class_map_states_classes_by_name_or_label(tmp_path):
    path = tmp_path / "world.xml"
    path.write_text("<mujoco><worldbody><body name='caddy_1'><geom size='.1'/></body></worldbody></mujoco>")
    known = ClassNames(household_classes())
    (caddy,) = open_world(path, Models(), classes=known, class_map={"caddy": "cesto"}).scene().bodies
    assert caddy.class_ == "Basket"
    with pytest.raises(BadFile, match="--class-map: unknown class 'Baskett'; did you mean Basket"):
        open_world(path, Models(), classes=known, class_map={"caddy": "Baskett"})


MJCF = '<mujoco><worldbody><body name="{name}"><geom size=".1"/></body></worldbody></mujoco>'


@pytest.mark.parametrize("relation", ["on", "in", "next_to"])
def test_a_world_has_positions_and_not_relations(tmp_path, relation):
    path = tmp_path / "world.json"
    cup = {"class": "Cup", "name": "cup1", relation: "table1"}
    path.write_text(json.dumps({"entities": [{"class": "Table", "at": [0, 0, 0]}, cup]}))
    with pytest.raises(BadFile, match=r"^world\.json: entity cup1: on, in and next_to place objects"):
        open_world(path, Models())
    path.write_text(json.dumps({"entities": [{"class": "Cup", relation: "table1"}]}))
    with pytest.raises(BadFile, match=r"^world\.json: entity 1: on, in and next_to"):
        require_world(path, Models())


def test_a_body_that_cannot_be_created_is_named(tmp_path):
    path = tmp_path / "world.json"
    far = {"class": "Cup", "name": "cup1", "at": [9000, 0, 0]}
    path.write_text(json.dumps({"entities": [far]}))
    with pytest.raises(BadFile, match=r"^world\.json: cup1 cannot be created: .* from the origin"):
        open_world(path, Models())


def test_bodies_of_a_scene_in_json_depend_on_classes_and_those_of_no_world_do_not(tmp_path):
    path = tmp_path / "world.json"
    path.write_text(json.dumps(SCENE))
    assert names_classes(path)
    assert not names_classes(None)


def test_a_world_is_checked_without_being_opened(tmp_path):
    path = tmp_path / "world.xml"
    path.write_text(MJCF.format(name="cup1"))
    require_world(path, Models())
    path.write_text("<mujoco><worldbody><body><geom/></body></worldbody></mujoco>")
    with pytest.raises(BadFile, match=r"world\.xml"):
        require_world(path, Models())
