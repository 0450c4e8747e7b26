import numpy as np
import pytest
import rerun as rr
from msgspec import structs

from semmap.nodes.drawing.articulation import articulated
from semmap.nodes.drawing.figures import figure_of
from semmap.nodes.drawing.neighbourhood import GraphNode, Neighbourhood
from semmap.nodes.recorder.drawing.drawn_scene import DrawnScene
from semmap.nodes.recorder.drawing.geometry import (
    leaf_paths_of,
    leaf_shapes_of,
    leaf_transforms_of,
    shape_of,
)
from semmap.schemas.entities import Pose
from semmap.schemas.joints import Joint
from semmap.schemas.polygons import EXTENT, box_around, read_wkt
from semmap.schemas.scenes import Leaf
from tests.recorder.messages import body, entity, pose, surface


class Told:
    """A recording that only lists its calls."""

    def __init__(self):
        self.calls = []

    def __getattr__(self, verb):
        return lambda name, *_: self.calls.append((verb, name))

    def take(self):
        calls, self.calls = self.calls, []
        return calls


@pytest.fixture
def told():
    return Told()


@pytest.fixture
def stage(told):
    return DrawnScene(told)


def test_what_appears_is_drawn_once(stage, told):
    stage.show_all({"c": entity("c")}, {}, simulated=False)
    assert told.take() == [("draw", "c")]
    stage.show_all({"c": entity("c")}, {}, simulated=False)
    assert told.take() == []


def test_a_body_gives_its_entity_another_shape(stage, told):
    stage.show_all({"c": entity("c")}, {}, simulated=True)
    told.take()
    stage.show_all({"c": entity("c")}, {"c": body("c")}, simulated=True)
    assert told.take() == [("draw", "c")]


def test_what_leaves_is_erased_and_may_come_back(stage, told):
    stage.show_all({"c": entity("c")}, {}, simulated=False)
    told.take()
    stage.show(["c"], {}, {}, simulated=False)
    assert told.take() == [("erase", "c")]
    stage.show(["c"], {"c": entity("c")}, {}, simulated=False)
    assert told.take() == [("draw", "c")]


def test_what_changes_its_branch_leaves_nothing_behind(stage, told):
    stage.show_all({}, {"c": body("c", entity=False)}, simulated=True)
    told.take()
    stage.show_all({"c": entity("c")}, {"c": body("c")}, simulated=True)
    assert told.take() == [("erase", "c"), ("draw", "c")]


def test_an_entity_that_is_nowhere_is_not_drawn(stage, told):
    stage.show_all({"c": entity("c")}, {}, simulated=False)
    told.take()
    stage.show(["c"], {"c": structs.replace(entity("c"), pose=None)}, {}, simulated=False)
    assert told.take() == [("erase", "c")]


def test_moves_are_told_when_they_are_moves(stage, told):
    stage.show_all({}, {"c": body("c")}, simulated=True)
    told.take()
    stage.move("c", pose(0.0001))
    stage.move("unknown", pose(1.0))
    assert told.take() == []
    stage.move("c", pose(0.5))
    assert told.take() == [("move", "c")]


def test_a_body_that_loses_its_surface_is_erased_first(stage, told):
    chair = body("c", model="chair")
    stage.show_all({}, {"c": chair}, simulated=True)
    stage.surfaces.take(("chair", chair.size_m), surface())
    stage.show_all({}, {"c": chair}, simulated=True)
    assert told.take() == [("draw", "c"), ("draw", "c")]
    stage.show_all({}, {"c": structs.replace(chair, ghost=True)}, simulated=True)
    assert told.take() == [("erase", "c"), ("draw", "c")]
    stage.show_all({}, {"c": chair}, simulated=True)
    assert told.take() == [("draw", "c")]


def cupboard(**others):
    """Return a body with a door in a frame, and a handle on the door, which turns and slides."""
    kinds = {"door": "hinge", "handle": "hinge", "latch": "slide"}
    joints = [Joint(name=name, kind=kinds[name], position=at) for name, at in others.pop("at", {}).items()]
    return body("c", model="cupboard", joints=tuple(joints), **others)


def leaf(joint, kind, axis, anchor, first, count):
    return Leaf(joint=joint, kind=kind, axis=axis, anchor=anchor, first=first, count=count)


def jointed():
    parts = surface()
    return structs.replace(
        parts,
        points=parts.points * 4,
        normals=parts.normals * 4,
        colours=parts.colours * 4,
        triangles=np.arange(12, dtype="<u4").tobytes(),
        leaves=(
            leaf("door", "hinge", (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), 3, 6),
            leaf("handle", "hinge", (1.0, 0.0, 0.0), (0.5, 0.0, 0.2), 6, 3),
            leaf("latch", "slide", (0.0, 1.0, 0.0), (0.0, 0.0, 0.0), 9, 3),
        ),
    )


def test_joints_move_leaves_and_do_not_draw_the_surface_again(stage, told):
    stage.surfaces.take(("cupboard", (0.5, 0.5, 1.0)), jointed())
    stage.show_all({}, {"c": cupboard()}, simulated=True)
    assert told.take() == [("draw", "c")]
    stage.show_all({}, {"c": cupboard(at={"door": 1.0})}, simulated=True)
    assert told.take() == [("bend", "c")]
    stage.show_all({}, {"c": cupboard(at={"door": 1.0})}, simulated=True)
    assert told.take() == []
    moved = structs.replace(cupboard(at={"door": 0.5}), pose=pose(1.0))
    stage.show_all({}, {"c": moved}, simulated=True)
    assert told.take() == [("bend", "c"), ("move", "c")]
    stage.show_all({}, {"c": cupboard(at={"door": 0.5}, ghost=True)}, simulated=True)
    assert told.take() == [("erase", "c"), ("draw", "c")]


def test_transforms_of_leaves_have_the_effect_of_the_joints():
    at = {"door": 1.0, "handle": -0.5, "latch": 0.3}
    figure = figure_of(None, cupboard(at=at), simulated=True, surface=jointed())
    paths = leaf_paths_of(figure)
    assert paths == [("door",), ("door", "handle"), ("latch",)]
    transforms = dict(zip(paths, leaf_transforms_of(figure), strict=True))
    found = [points_of(shape_of(figure)[1])]
    for path, (mesh,) in zip(paths, leaf_shapes_of(figure), strict=True):
        points = points_of(mesh)
        for length in range(len(path), 0, -1):  # from the leaf to what holds it
            transform = transforms[path[:length]]
            columns = np.array(transform.mat3x3.as_arrow_array().to_pylist()).reshape(3, 3)
            points = points @ columns + np.array(transform.translation.as_arrow_array().to_pylist())
        found.append(points)
    expected = np.frombuffer(articulated(jointed(), figure.joint_positions).points, "<f4").reshape(-1, 3)
    assert np.concatenate(found) == pytest.approx(expected, abs=1e-5)


def points_of(mesh):
    return np.array(mesh.vertex_positions.as_arrow_array().to_pylist())


def test_a_graph_is_drawn_when_it_changes(stage, told):
    stage.show_graph(Neighbourhood((GraphNode("cup1", "cup1", "centre", "Cup"),)))
    stage.show_graph(Neighbourhood((GraphNode("cup1", "cup1", "centre", "Cup"),)))
    assert [verb for verb, _ in told.take()] == ["graph"]


def test_a_place_with_a_polygon_is_a_sheet_of_its_shape_with_borders_and_another_a_box():
    wkt = "POLYGON ((20 0, 26 0, 26 2, 22 2, 22 5, 20 5, 20 0))"
    at, size = box_around(read_wkt(wkt), 0.0, 2.5)
    room = structs.replace(
        entity("room1", "Room", place=True), pose=Pose(position_m=at), size_m=size, properties={EXTENT: wkt}
    )
    covered, border, _ = shape_of(figure_of(room, None, simulated=True))
    assert isinstance(covered, rr.Mesh3D)
    corners = np.array(covered.vertex_positions.as_arrow_array().to_pylist())
    assert np.allclose(corners[:, :2].min(axis=0), (-3.0, -2.5))
    assert len(set(corners[:, 2].tolist())) == 1
    assert isinstance(border, rr.LineStrips3D)
    (strip,) = border.strips.as_arrow_array().to_pylist()
    assert strip[0] == pytest.approx(strip[-1])
    assert {round(point[0], 6) for point in strip} == {-3.0, -1.0, 3.0}

    sheet, _ = shape_of(figure_of(structs.replace(room, properties={}), None, simulated=True))
    assert isinstance(sheet, rr.Boxes3D)
