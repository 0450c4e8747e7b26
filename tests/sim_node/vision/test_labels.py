import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from semmap.nodes.sim_node.vision.labels import draw_labels, find_tops, free_place, project_points
from semmap.nodes.sim_node.vision.view import look_at


def test_a_point_is_where_the_camera_sees_it():
    view = look_at(np.array([0.0, 0.0, 5.0]), np.zeros(3), 200, 100, 1.0)
    points = {"middle": np.zeros(3), "right": np.array([1.0, 0.0, 0.0]), "behind": np.array([0.0, 0.0, 9.0])}
    found = project_points(view, {**points, "outside": np.array([50.0, 0.0, 0.0])})
    assert set(found) == {"middle", "right"}
    assert found["middle"] == pytest.approx((100.0, 50.0))
    assert found["right"][0] > 100.0


def test_a_label_is_at_the_top_of_its_body_without_nested_bodies():
    model = mujoco.MjModel.from_xml_string(
        """<mujoco><worldbody><geom type="plane" size="5 5 .1"/>
        <body name="table" pos="1 0 0"><geom type="box" size=".5 .4 .35" pos="0 0 .35"/>
        <body name="book" pos="0 .1 .72"><geom type="box" size=".1 .1 .02"/></body></body>
        </worldbody></mujoco>"""
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    tops = find_tops(model, data, ["", "table", "book"])
    assert tops.keys() == {"table", "book"}
    assert tops["table"] == pytest.approx((1.0, 0.0, 0.7))
    assert tops["book"] == pytest.approx((1.0, 0.1, 0.74))
    above = np.array([0.0, -1.0, 0.71]), np.array([2.0, 1.0, 1.0])
    assert find_tops(model, data, ["", "table", "book"], above).keys() == {"book"}


@given(
    points=st.lists(st.tuples(st.floats(0, 399), st.floats(0, 299)), max_size=30),
    size=st.tuples(st.floats(5, 80), st.floats(5, 20)),
)
def test_labels_lie_in_the_picture_and_over_none_of_the_others(points, size):
    taken = []
    for point in points:
        if (box := free_place(point, size, (400, 300), taken)) is not None:
            assert box[0] >= 0
            assert box[1] >= 0
            assert box[2] <= 400 + 1e-9
            assert box[3] <= 300 + 1e-9
            for other in taken:
                assert box[2] <= other[0] or other[2] <= box[0] or box[3] <= other[1] or other[3] <= box[1]
            taken.append(box)
    assert bool(taken) == bool(points)


def test_a_label_changes_the_picture_beside_its_point_only():
    plain = Image.new("RGB", (400, 300), (90, 90, 90))
    shown = np.asarray(draw_labels(plain, {"cup1": (100.0, 100.0)}))
    changed = np.argwhere((shown != 90).any(axis=2))
    assert len(changed)
    assert (np.abs(changed - [100, 100]) < [40, 60]).all()
    assert (np.asarray(draw_labels(plain, {})) == 90).all()


def test_labels_of_one_point_are_below_and_above_it_in_turn_until_they_are_too_far():
    taken = []
    while (box := free_place((100.0, 500.0), (20.0, 10.0), (400, 1000), taken)) is not None:
        taken.append(box)
    assert [box[1] for box in taken[:5]] == [495.0, 506.0, 484.0, 517.0, 473.0]
    assert {box[0] for box in taken} == {90.0}
    assert len(taken) == 15
