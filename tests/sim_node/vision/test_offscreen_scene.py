"""A scene for videos: bodies are placed exactly."""

import numpy as np
import pytest
from msgspec import structs

from semmap.nodes.sim_node.vision.offscreen_scene import OffscreenScene
from semmap.schemas.errors import BadRequest
from tests.sim_node.orders import order, pose

KITCHEN = """<mujoco><worldbody><geom type="plane" size="9 9 1"/>
  <camera name="above" pos="0 0 4" fovy="60"/>
  <body name="shelf_1" pos="5 0 0.5"><geom type="box" size="0.2 0.5 0.5"/></body>
</worldbody></mujoco>"""


@pytest.fixture
def film():
    return OffscreenScene(None, graphics=False)


def boxes(*x, fixed=False):
    return [
        order(f"box{k}", "", pose(at, 0.0, 0.5), size_m=(0.4, 0.4, 0.4), fixed=fixed)
        for k, at in enumerate(x)
    ]


def test_bodies_come_and_go_and_why_some_do_not_is_told(film):
    assert film.add(boxes(0.0, 2.0)) == {}
    assert "box0" in film
    assert "box0" in film.add([order("box0", "", pose(5000.0, 0.0), size_m=(0.4, 0.4, 0.4))])
    assert "box0" not in film
    film.add(boxes(0.0))
    film.remove(["box0", "missing"])
    assert "box0" not in film
    assert "box1" in film
    film.remove(["missing"])
    assert film.add([]) == {}


@pytest.mark.parametrize("fixed", [False, True])
def test_bodies_stand_where_they_are_put_in_the_air_and_in_one_another(film, fixed):
    film.add(boxes(0.0, 2.0, fixed=fixed))
    film.put({"box0": pose(2.1, 0.0, 0.5), "missing": pose(0.0, 0.0)})
    low, high = film.extent()
    assert low == pytest.approx((1.8, -0.2, 0.5))
    assert high == pytest.approx((2.3, 0.2, 0.9))


def test_a_world_s_own_bodies_and_cameras_are_there_and_entities_of_a_json_scene_are_not(tmp_path):
    path = tmp_path / "kitchen.xml"
    path.write_text(KITCHEN)
    film = OffscreenScene(path, graphics=False)
    assert "shelf_1" in film
    assert film.view(40, 30, camera="above").map_from_camera[:3, 3] == pytest.approx((0, 0, 4))
    with pytest.raises(BadRequest):
        film.view(40, 30, camera="below")
    scene = tmp_path / "scene.json"
    scene.write_text('{"entities": [{"class": "Table"}]}')
    assert "table1" not in OffscreenScene(scene, graphics=False)


def test_a_body_of_the_world_file_is_used_for_an_entity_of_its_size_and_moved_with_its_joints(tmp_path):
    path = tmp_path / "kitchen.xml"
    path.write_text("""<mujoco><worldbody>
      <body name="box1" pos="0 0 0"><geom type="box" size=".2 .2 .2" pos="0 0 .2"/>
        <body name="flap" pos="-.2 0 .41"><joint name="lid" axis="0 -1 0" range="0 90"/>
          <geom type="box" size=".2 .2 .01" pos=".2 0 0"/></body></body>
      <body name="ball1" pos="2 0 .1"><freejoint/><geom size=".1"/></body>
      <body name="table1" pos="9 0 0"><geom type="box" size=".5 .5 .4" pos="0 0 .4"/></body>
    </worldbody></mujoco>""")
    film = OffscreenScene(path, graphics=False)
    box = order("box1", "box", pose(1.0, 1.0), size_m=(0.4, 0.4, 0.42))
    assert (
        film.add(
            [
                structs.replace(box, properties={"openness": 1.0}),
                order("ball1", "ball", pose(3.0, 0.0), size_m=None),
                order("table1", "table", pose(5.0, 0.0), size_m=(1.2, 0.8, 0.7)),
            ]
        )
        == {}
    )
    engine = film._engine
    assert [engine.shape(name) is None for name in ("box1", "ball1", "table1")] == [True, True, False]
    poses = dict(zip(engine.index.names, engine.poses().tolist(), strict=True))
    assert poses["box1"][:3] == pytest.approx((1.0, 1.0, 0.0))
    assert poses["ball1"][:3] == pytest.approx((3.0, 0.0, 0.0))
    assert engine.positions()[0] == pytest.approx(np.pi / 2)
    film.add([box])
    assert engine.positions()[0] == 0.0


def test_a_view_may_be_of_a_box_from_above_or_of_all(film):
    film.add(boxes(0.0, 2.0))
    above = film.view(40, 30, box=((0.0, 0.0, 0.0), (2.0, 1.0, 1.0)))
    assert above.map_from_camera[2, 2] < -0.95
    assert above.map_from_camera[0, 3] == pytest.approx(1.0)
    everything = film.view(40, 30)
    assert (everything.width, everything.height) == (40, 30)
    assert everything.map_from_camera[2, 2] > -0.95


def test_a_picture_shows_bodies_and_the_names_that_are_asked_for(film):
    film.add(boxes(0.0, 2.0))
    view = film.view(160, 120)
    plain = film.picture(view, {})
    assert plain.shape == (120, 160, 3)
    assert not film.has_graphics
    named = film.picture(view, {"box0": "first", "missing": "missing"})
    assert named.shape == plain.shape
    assert (named != plain).any()
    assert (film.picture(view, {"missing": "missing"}) == plain).all()
    film.put({"box0": pose(5.0, 5.0)})
    assert (film.picture(view, {}) != plain).any()
