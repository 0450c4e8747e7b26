"""From the columns of a file to a cloud: units, axes and colours."""

import numpy as np
import pytest

from semmap.nodes.perception_node.input.files.columns import cloud_of, columns_of_text

SEEN = np.array([(0.1, 0.2, 1.0), (-0.3, 0.4, 2.0), (0.5, -0.6, 3.0), (-0.7, -0.8, 4.0)])


def columns(points=SEEN, **more):
    return dict(zip("xyz", np.asarray(points, float).T, strict=True)) | more


def read(points=SEEN, height=1, **more):
    cloud = cloud_of(columns(points, **more), height, len(points) // height)
    return cloud.points_camera.reshape(-1, 3), cloud


def test_points_are_rows_and_columns_of_the_picture():
    points, cloud = read(height=2)
    assert points == pytest.approx(SEEN)
    assert cloud.points_camera.shape == (2, 2, 3)
    assert cloud.points_camera.dtype == np.float32
    assert cloud.colors is None


def test_what_no_camera_measures_was_not_seen():
    points, _ = read(
        [(0.1, 0.2, 1.0), (0, 0, 0.005), (0, 0, 101.0), (101.0, 0, 1), (np.nan, 0, 1), (0, 0, 0)]
    )
    assert np.isnan(points).all(axis=1).tolist() == [False, True, True, True, True, True]


@pytest.mark.parametrize(
    ("as_seen", "name"),
    [
        (SEEN * (1, -1, -1), "OpenGL"),
        (SEEN[:, [2, 0, 1]] * (1, -1, -1), "ROS"),
        (SEEN[:, [0, 2, 1]] * (1, 1, -1), "y forward"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_axes_of_other_conventions_are_turned(as_seen, name):
    assert read(as_seen)[0] == pytest.approx(SEEN)


def test_a_few_points_behind_the_camera_do_not_turn_it():
    points = np.concatenate([np.tile(SEEN, (3, 1)), [(0.1, 0.1, -1.0), (0.1, 0.1, -1.0)]])
    found, _ = read(points)
    assert found[:12] == pytest.approx(np.tile(SEEN, (3, 1)))
    assert np.isnan(found[12:]).all()


def test_axes_of_nobody_s_are_told_with_how_many_points_lie_behind():
    with pytest.raises(ValueError, match="50% of its points are behind the camera"):
        read([(1, 1, 1), (-1, -1, -1), (1, -1, 1), (-1, 1, -1)])
    with pytest.raises(ValueError, match="are behind"):
        read([(1, 1, 1), (1, 1, -1)])  # x and y might both be forward


@pytest.mark.parametrize(("factor", "unit"), [(1000.0, "millimetres"), (100.0, "centimetres")])
def test_other_units_are_told_with_the_factor(factor, unit):
    with pytest.raises(ValueError, match=rf"the unit is probably {unit}: multiply them by {1 / factor:g}"):
        read(np.concatenate([SEEN * factor, np.zeros((8, 3))]))  # zeros are not measured


def test_missing_columns_are_named():
    with pytest.raises(ValueError, match="it has no field y, z, only x, label"):
        cloud_of({"x": SEEN[:, 0], "label": SEEN[:, 0]}, 1, 4)
    with pytest.raises(ValueError, match="no field x, y, z, only none"):
        cloud_of({}, 1, 0)


def test_a_cloud_in_which_nothing_was_seen_is_one():
    points, _ = read(np.full((4, 3), np.nan))
    assert np.isnan(points).all()


RGB = [(255, 128, 1), (0, 0, 0), (1, 2, 3), (9, 8, 7)]
PACKED = np.array([r << 16 | g << 8 | b for r, g, b in RGB], np.uint32)


@pytest.mark.parametrize(
    "more",
    [
        {"rgb": PACKED},
        {"rgb": PACKED.view(np.float32)},
        {"rgba": (PACKED | 0x80000000).view(np.int32)},
        dict(zip(("red", "green", "blue"), np.array(RGB).T, strict=True)),
        {**dict(zip(("red", "green", "blue"), np.array(RGB).T, strict=True)), "rgb": PACKED * 0},
    ],
    ids=["packed", "as a float", "with transparency", "in three columns", "in both"],
)
def test_colours_are_read(more):
    assert read(**more)[1].colors.reshape(-1, 3).tolist() == [list(rgb) for rgb in RGB]


def test_colours_out_of_range_are_cut_and_what_is_no_colour_is_none():
    values = np.array([-5.0, 300.0, np.nan, 7.0])
    colors = read(red=values, green=values, blue=values)[1].colors
    assert colors.reshape(-1, 3)[:, 0].tolist() == [0, 255, 0, 7]
    assert read(red=values, green=values)[1].colors is None
    assert read(rgb=PACKED.astype(np.uint8))[1].colors is None


FIELDS = [("x", np.dtype("f4"), 1), ("normal", np.dtype("f4"), 3), ("label", np.dtype("u1"), 1)]


def test_numbers_in_words_go_to_their_fields_and_those_of_several_are_passed_over():
    found = columns_of_text(b"1 7 7 7 2\n3.5 7 7 7 4\n9", FIELDS, 2)
    assert found.keys() == {"x", "label"}
    assert found["x"].tolist() == [1.0, 3.5]
    assert found["label"].tolist() == [2, 4]
    assert found["label"].dtype == np.uint8


def test_too_few_numbers_are_told_in_points():
    with pytest.raises(ValueError, match="truncated: 1 of 2 points"):
        columns_of_text(b"1 7 7 7 2\n3.5 7 7 7", FIELDS, 2)


def test_a_cloud_in_the_frame_of_a_map_is_read_with_its_pose_and_a_note():
    floor = np.random.default_rng(0).uniform([-1, -1, 0.02], [1, 1, 0.02], (4000, 3))
    box = np.random.default_rng(1).uniform([0.2, 0.1, 0.02], [0.3, 0.2, 0.3], (800, 3))
    columns = dict(zip("xyz", np.concatenate([floor, box]).T, strict=True))
    cloud = cloud_of(columns, 1, 4800)
    (note,) = cloud.notes
    assert "with z up" in note
    seen = cloud.points_camera[0] @ cloud.map_from_camera[:3, :3].T + cloud.map_from_camera[:3, 3]
    assert np.nanquantile(seen[:, 2], [0.01, 0.99]) == pytest.approx([0.02, 0.28], abs=0.02)
    assert "--up -z" in cloud_of({axis: -along for axis, along in columns.items()}, 1, 4800).notes[1]


def test_a_cloud_around_the_origin_without_a_level_is_noted():
    around = np.random.default_rng(0).normal([0.0, 0.0, 3.0], 1.0, (4000, 3))
    cloud = cloud_of(dict(zip("xyz", around.T, strict=True)), 1, 4000)
    assert "no level surface" in cloud.notes[0]
