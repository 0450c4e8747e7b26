"""A solid that replaces another equals a new one."""

from __future__ import annotations

import math

import pytest

from semmap.nodes.geometry.polygons import area
from semmap.nodes.kb_node.relations.geometry.forms import form_of
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.geometry.solids import solid_of
from semmap.ontology.model_shapes import Interior
from semmap.schemas.entities import Pose, Size

TURNED = (0.9238795325112867, 0.0, 0.0, 0.3826834323650898)
LEANING = (0.9961946980917455, 0.08715574274765817, 0.0, 0.0)
HERE = (1.0, 2.0, 0.3)


def _placed(
    at: tuple[float, float, float],
    turn: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0),
    size: Size | None = (0.4, 0.3, 0.7),
    model: str = "chair",
    *,
    place: bool = False,
) -> PlacedEntity:
    pose = Pose(position_m=at, orientation_wxyz=turn)
    return PlacedEntity(
        name="a", iri="http://example.org/a", pose=pose, size_m=size, place=place, model=model
    )


@pytest.mark.parametrize(
    "now",
    [
        _placed((4.1, -2.7, 0.3)),
        _placed((4.1, -2.7, HERE[1])),
        _placed((4.1, -2.7, 0.3), TURNED),
        _placed((4.1, -2.7, 0.3), size=(0.4, 0.3, 0.8)),
        _placed((4.1, -2.7, 0.3), size=None),
        _placed((4.1, -2.7, 0.3), model=""),
        _placed((4.1, -2.7, 0.3), place=True),
        _placed((4.1, -2.7, 0.3), LEANING),
    ],
)
@pytest.mark.parametrize("turn", [(1.0, 0.0, 0.0, 0.0), LEANING])
def test_bounds_bottom_and_top_after_a_change(
    now: PlacedEntity, turn: tuple[float, float, float, float]
) -> None:
    before = solid_of(_placed(HERE, turn))
    fresh, moved = solid_of(now), solid_of(now, before)
    assert fresh is not None
    assert moved is not None
    assert (moved.bounds, moved.bottom, moved.top) == (fresh.bounds, fresh.bottom, fresh.top)
    assert (moved.is_place, moved.is_measured) == (fresh.is_place, fresh.is_measured)


def test_a_horizontal_move_needs_no_parts() -> None:
    before = solid_of(_placed(HERE, size=(0.41, 0.31, 0.71)))
    assert before is not None
    before.form.clear_cache()
    now = solid_of(_placed((5.0, 5.0, 0.3), size=(0.41, 0.31, 0.71)), before)
    assert now is not None
    assert now.bottom == before.bottom
    assert "parts" not in form_of("chair", (0.41, 0.31, 0.71), (1.0, 0.0, 0.0, 0.0)).__dict__


@pytest.mark.parametrize(("size", "is_shared"), [((0.42, 0.32, 0.72), True), ((0.43, 0.33, 0.73), False)])
def test_a_form_keeps_its_parts_while_another_solid_uses_it(size: Size, is_shared: bool) -> None:
    before = solid_of(_placed(HERE, size=size))
    other = solid_of(_placed((3.0, 0.0, 0.0), size=size)) if is_shared else None
    moved = solid_of(_placed((5.0, 5.0, 1.3), size=size), before)
    assert moved is not None
    assert moved.parts
    moved.clear_cache()
    assert ("parts" in moved.form.__dict__) == (other is not None)


@pytest.mark.parametrize("turn", [(1.0, 0.0, 0.0, 0.0), TURNED, LEANING])
def test_a_point_in_the_map_is_the_same_point_in_its_own_frame(
    turn: tuple[float, float, float, float],
) -> None:
    solid = solid_of(_placed(HERE, turn))
    assert solid is not None
    point = (0.1, -0.2, 0.5)
    assert solid.to_own(solid.to_map(point)) == pytest.approx(point)
    assert solid.to_map((0.0, 0.0, 0.0)) == pytest.approx(HERE)
    assert [sum(axis) / len(axis) for axis in zip(*solid.samples, strict=True)] == pytest.approx(solid.centre)
    assert len(set(solid.samples)) == 125
    xs, ys = zip(*solid.outline, strict=True)
    assert (min(xs), min(ys), max(xs), max(ys)) == pytest.approx(solid.bounds)


@pytest.mark.parametrize(("is_round", "covered"), [(False, 0.08), (True, 0.08 * math.pi / 4)])
def test_the_walls_of_a_hollow_are_on_the_floor_plan(is_round: bool, covered: float) -> None:
    solid = solid_of(_placed(HERE, TURNED))
    assert solid is not None
    hollow = Interior(low=(0.0, -0.1, 0.3), high=(0.4, 0.1, 0.5), round=is_round)
    walls = solid.outline_of(hollow)
    assert area(walls) == pytest.approx(covered)
    middle = tuple(sum(along) / len(walls) for along in zip(*walls, strict=True))
    assert middle == pytest.approx(solid.to_map((0.2, 0.0, 0.3))[:2])
    furthest = max(math.dist(middle, wall) for wall in walls)
    assert furthest == pytest.approx(0.2 * 1.0539 if is_round else math.hypot(0.2, 0.1), abs=1e-4)


def test_a_place_and_a_point_have_no_parts() -> None:
    place, point = solid_of(_placed(HERE, place=True)), solid_of(_placed(HERE, size=None, model=""))
    for solid in (place, point):
        assert solid is not None
        assert (solid.has_parts, solid.parts, solid.base, solid.supports) == (False, (), [], ())
        assert (solid.lowest_top, solid.highest_bottom) == (solid.top, solid.bottom)
    chair = solid_of(_placed(HERE))
    assert chair is not None
    assert chair.has_parts
    assert HERE[2] <= chair.highest_bottom < chair.top
    assert HERE[2] < chair.lowest_top <= chair.top
