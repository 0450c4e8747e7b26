import math

from semmap.nodes.drawing.figures import UNKNOWN_SIZE_M, Figure, figure_of, is_still, pose_of
from semmap.schemas.entities import orientation_from_yaw
from tests.recorder.messages import body, entity, pose


def test_the_scene_knows_the_size_better_than_the_map():
    chair = entity("chair1", size_m=(1.0, 1.0, 1.0))
    figure = figure_of(chair, body("chair1"), simulated=True)
    assert figure == Figure("chair1", "Chair", (0.5, 0.5, 1.0), "solid")


def test_without_a_simulator_the_map_is_drawn():
    assert figure_of(entity("c", size_m=(1.0, 2.0, 3.0)), None, simulated=False) == Figure(
        "c", "Chair", (1.0, 2.0, 3.0), "solid"
    )
    unsized = figure_of(entity("c"), None, simulated=False)
    assert unsized is not None
    assert unsized.size_m == UNKNOWN_SIZE_M


def test_an_entity_that_the_simulator_lacks_is_only_believed():
    figure = figure_of(entity("c"), None, simulated=True)
    assert figure is not None
    assert figure.appearance == "believed"


def test_ghosts_furniture_and_places():
    ghost = figure_of(entity("c"), body("c", ghost=True), simulated=True)
    furniture = figure_of(None, body("wall", class_=None, entity=False), simulated=True)
    place = figure_of(entity("k", "Kitchen", place=True, preferred_reference="kitchen"), None, simulated=True)
    assert [f and (f.appearance, f.group, f.label) for f in (ghost, furniture, place)] == [
        ("ghost", "bodies", "c"),
        ("furniture", "furniture", "wall"),
        ("place", "places", "kitchen"),
    ]


def test_nothing_has_no_figure():
    assert figure_of(None, None, simulated=True) is None


def test_the_scene_knows_the_pose_better_than_the_map():
    assert pose_of(entity("c", at=pose(1.0)), body("c", at=pose(2.0))) == pose(2.0)
    assert pose_of(entity("c", at=pose(1.0)), None) == pose(1.0)
    assert pose_of(None, None) is None


def test_a_tremor_is_no_movement():
    assert is_still(pose(1.0), pose(1.0005))
    assert not is_still(pose(1.0), pose(1.002))
    assert not is_still(pose(), pose(wxyz=orientation_from_yaw(math.radians(1.0))))
