import numpy as np
import pytest

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.pipeline import Parts, observe, observe_clouds, observe_views
from semmap.nodes.perception_node.recognition.recognition_model import shipped
from semmap.nodes.perception_node.views.merged_thing import thing_of
from semmap.nodes.perception_node.views.segment_memory import Recalled, SegmentMemory
from semmap.nodes.perception_node.views.segments import Segment, map_points
from semmap.nodes.perception_node.views.supports import Support
from tests.perception_node.scenes import HEIGHT_M, KINDS, shot
from tests.perception_node.views.test_segment_memory import seen_from


@pytest.fixture(scope="module")
def seen():
    return observe_clouds(shot().clouds, shipped())


def nearest(observations, x, y):
    return min(observations, key=lambda o: np.hypot(o.pose.position_m[0] - x, o.pose.position_m[1] - y))


@pytest.mark.parametrize("kind", KINDS)
def test_things_of_two_views_are_one_observation_each(seen, kind):
    x, y = KINDS[kind]
    observation = nearest([o for o in seen.observations.observations if max(o.size_m) < 0.7], x, y)
    body = next(body for body in shot().bodies if body.name == kind)
    assert observation.pose.position_m == pytest.approx((x, y, HEIGHT_M), abs=0.03)
    assert [*sorted(observation.size_m[:2]), observation.size_m[2]] == pytest.approx(
        [*sorted(body.size_m[:2]), body.size_m[2]], abs=0.04
    )
    assert observation.class_ in {
        "cereals": "Cereals Food",
        "bottle": "Bottle Wine Drink Vessel Container",
    }.get(kind, f"{kind.title()} Fruit Food Container Object")


def test_a_table_is_a_thing_too(seen):
    table = max(seen.observations.observations, key=lambda o: o.size_m[0] * o.size_m[1])
    assert table.pose.position_m[2] == pytest.approx(0.0, abs=0.02)
    assert table.size_m[2] == pytest.approx(HEIGHT_M, abs=0.03)


def test_labels_name_the_observations(seen):
    for label, cloud in zip(seen.labels, shot().clouds, strict=True):
        assert label.shape == cloud.points_camera.shape[:2]
        assert label.max() <= len(seen.observations.observations)
    together = np.concatenate([label.ravel() for label in seen.labels])
    assert set(range(1, len(seen.observations.observations) + 1)) <= set(together.tolist())


def test_the_views_are_told(seen):
    view = seen.observations.views[1]
    assert view.map_from_camera == pytest.approx(shot().clouds[1].map_from_camera.ravel())
    assert (view.width, view.height) == (640, 480)


def test_a_cloud_of_unknown_pose_stands_on_its_largest_plane():
    cloud = shot().clouds[0]
    height = map_points(cloud, cloud.map_from_camera)[..., 2:]
    table_alone = np.where(height > HEIGHT_M - 0.05, cloud.points_camera, np.float32(np.nan))
    alone = observe([Cloud(table_alone, cloud.colors)], shipped())
    bottoms = [o.pose.position_m[2] for o in alone.observations]
    assert len(bottoms) >= 3
    assert bottoms == pytest.approx(np.zeros(len(bottoms)), abs=0.02)


def cloud_of(points, **more):
    return Cloud(np.asarray(points, np.float32), **more)


@pytest.mark.parametrize(
    "points",
    [
        np.full((4, 6, 3), np.nan),
        np.zeros((1, 0, 3)),
        np.full((1, 1, 3), 1.0),
        np.ones((48, 64, 3)),
        np.full((1, 500, 3), np.nan),
    ],
)
def test_what_shows_nothing_gives_nothing(points):
    assert observe([cloud_of(points, map_from_camera=np.eye(4))], shipped()).observations == ()


def test_no_cloud_no_observation():
    assert observe([], shipped()).observations == ()


def test_intrinsics_of_another_camera_do_no_worse_than_one_camera():
    first, second = shot().clouds
    wrong = np.array([[5.0, 0.0, -900.0], [0.0, 5.0, 2000.0], [0.0, 0.0, 1.0]])
    strange = Cloud(second.points_camera, second.colors, second.map_from_camera, wrong)
    assert len(observe([first, strange], shipped()).observations) >= len(KINDS)


def part(low, high, *, cut=False):
    """Return a segment of points in a box (corners [m]) that a camera above it sees."""
    points = np.random.default_rng(0).uniform(low, high, (200, 3)).astype(np.float32)
    ends = points[points[:, 0] > high[0] - 0.02] if cut else np.empty((0, 3), np.float32)
    return Segment(points, None, 1, np.array([0.0, -1.0, 1.0]), cut, len(points), ends=ends)


def test_only_things_that_an_image_edge_cuts_are_completed_from_memory():
    floor = Support(0.0)
    cut, whole = part((0.0, 0, 0), (0.2, 0.1, 0.1), cut=True), part((1.0, 0, 0), (1.2, 0.1, 0.1))
    things = [thing_of([one], [floor]) for one in (whole, cut)]
    parts = Parts(things, (), np.zeros((2, 2, 2)), [floor])
    rests = [
        part((0.2, 0, 0), (0.3, 0.1, 0.1)),
        part((0.3, 0, 0), (0.4, 0.1, 0.1)),
        part((1.2, 0, 0), (1.4, 0.1, 0.1)),
    ]
    recalled = [Recalled(rests[0], 2), Recalled(rests[1], 2), Recalled(rests[2], 1), Recalled(rests[2], 0)]
    same, longer = parts.completed(recalled).things
    assert same is things[0]
    assert longer.cells[:, 0].max() == pytest.approx(0.4, abs=0.02)
    assert (len(longer.segments), longer.whole, longer.count) == (3, True, 600)
    assert parts.completed([]).things == things


def test_joined_parts_are_one_thing_on_the_support_below_both():
    one, other = (thing_of([part((x, 0, 0.7), (x + 0.1, 0.1, 0.8))], []) for x in (0.0, 0.1))
    both = Parts([one, other], (), np.zeros((2, 2, 2)), [Support(0.0), Support(0.69)]).join(one, other)
    assert both.segments == (*one.segments, *other.segments)
    assert both.box.low[2] == pytest.approx(0.69)
    assert both.box.size_m[:2].max() == pytest.approx(0.2, abs=0.01)


def test_memory_completes_a_thing_in_view_and_keeps_what_is_out_of_view():
    """A moving camera sees a board of 3 m in parts; at last it looks beside the remembered part."""
    memory = SegmentMemory()
    for x in (-0.8, -0.3, 0.4):
        found = observe_views([seen_from(x)], shipped(), before=memory)
        memory = found.remembered
    (board,) = (*found.things, *(thing for thing, _ in found.dropped))
    assert board.cells[:, 0].min() == pytest.approx(-1.5, abs=0.03)
    assert board.whole
    without = observe_views([seen_from(0.0, board=False)], shipped(), before=memory)
    x = np.concatenate([segment.points[:, 0] for segment in without.remembered.segments])
    assert np.abs(x).min() > 1.3
    assert (x.min(), x.max()) == pytest.approx((-1.5, 1.5), abs=0.03)
