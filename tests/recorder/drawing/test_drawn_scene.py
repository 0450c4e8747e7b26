import numpy as np
import pytest
import rerun as rr
from msgspec import structs

from semmap.nodes.drawing.figures import figure_of
from semmap.nodes.drawing.neighbourhood import GraphNode, Neighbourhood
from semmap.nodes.recorder.drawing.drawn_scene import DrawnScene
from semmap.nodes.recorder.drawing.geometry import shape_of
from semmap.schemas.entities import Pose
from semmap.schemas.polygons import EXTENT, box_around, read_wkt
from tests.recorder.messages import body, entity, pose


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
