"""Distances of axis-aligned boxes and of upright parts equal those of the search."""

import math
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from semmap.nodes.geometry.polygons import area
from semmap.nodes.kb_node.relations.geometry.convex import (
    _search_contact,
    contact,
    find_face,
    make_convex,
    over_flat_top,
    translate,
)
from semmap.nodes.kb_node.relations.geometry.solids import solid_of
from tests.kb_node.relations.entities import thing

AT = st.tuples(*[st.sampled_from([-0.7, -0.4, -0.1, 0.0, 0.05, 0.3, 0.5, 0.8])] * 3)
SIZE = st.tuples(*[st.sampled_from([0.1, 0.3, 0.6])] * 3)
YAW = 0.6


def box(at, size, yaw):
    (part,) = solid_of(thing("box1", at, "", size=size, yaw=yaw)).parts
    return part


def turned(x, y, z):
    return math.cos(YAW) * x - math.sin(YAW) * y, math.sin(YAW) * x + math.cos(YAW) * y, z


@settings(deadline=None, max_examples=100)
@given(AT, SIZE, AT, SIZE)
def test_boxes_along_the_axes(at, size, other_at, other_size):
    one, other = box(at, size, 0.0), box(other_at, other_size, 0.0)
    assert one.is_square
    searched_one, searched_other = box(turned(*at), size, YAW), box(turned(*other_at), other_size, YAW)
    assert not searched_one.is_square
    found, searched = contact(one, other), contact(searched_one, searched_other)
    # The search ends at a normal that may be some tenths of a degree off, which counts with the lever arm; of
    # 245 000 random pairs the worst was 0.0045 of it.
    lever = math.dist(at, other_at) + math.hypot(*size) / 2.0 + math.hypot(*other_size) / 2.0
    assert searched.distance - 1e-9 <= found.distance <= searched.distance + 5e-3 * lever
    assert math.hypot(*found.normal) == pytest.approx(1.0)


LENGTH = st.sampled_from([0.05, 0.1, 0.2, 0.35])
TURN = st.sampled_from([0.0, 0.3, YAW, 1.2])


@st.composite
def upright(draw):
    """Return a box, a cylinder, or a cylinder with an oval base."""
    a, b, c = draw(LENGTH), draw(LENGTH), draw(LENGTH)
    cos, sin = math.cos(turn := draw(TURN)), math.sin(turn)
    level = ((a * cos, a * sin, 0.0), (-b * sin, b * cos, 0.0))
    up = (0.0, 0.0, c)
    return (
        make_convex(draw(AT), (up,), level)
        if draw(st.booleans())
        else make_convex(draw(AT), (*level, up), ())
    )


@settings(deadline=None, max_examples=300)
@given(upright(), upright())
def test_upright_distances_equal_the_search(one, other):
    if one.is_square and other.is_square:
        return
    found, searched = contact(one, other), _search_contact(one, other, math.inf)
    assert found.distance == pytest.approx(searched.distance, abs=1e-12)
    assert found.normal == pytest.approx(searched.normal, abs=1e-12)


def test_a_deep_side_overlap_is_not_above():
    post = make_convex((0.0, 0.0, 0.5), ((0.0, 0.0, 0.5),), ((0.1, 0.0, 0.0), (0.0, 0.1, 0.0)))
    beside = make_convex((0.19, 0.0, 0.55), ((0.0, 0.0, 0.5),), ((0.1, 0.0, 0.0), (0.0, 0.1, 0.0)))
    found = contact(beside, post)
    assert found.distance == pytest.approx(-0.01, abs=1e-6)
    assert found.normal == pytest.approx((1.0, 0.0, 0.0), abs=1e-3)


def test_the_normal_points_from_the_other_to_the_one():
    found = contact(box((0.0, 0.0, 1.0), (0.2, 0.2, 0.2), 0.0), box((0.0, 0.0, 0.5), (0.4, 0.4, 0.4), 0.0))
    assert found.distance == pytest.approx(0.1)
    assert found.normal == (0.0, 0.0, 1.0)


def test_touching_parts_have_no_distance():
    found = contact(box((0.4, 0.0, 0.5), (0.6, 0.1, 0.1), 0.0), box((0.0, 0.0, 0.0), (0.5, 0.5, 0.5), 0.0))
    assert found == (0.0, (0.0, 0.0, 1.0))


def test_a_contact_is_computed_once():
    one, other = box((0.0, 0.0, 0.0), (0.3, 0.3, 0.3), YAW), box((0.34, 0.0, 0.0), (0.3, 0.3, 0.3), 0.0)
    assert contact(one, other) is contact(one, other)
    assert contact(one, other, -0.1) is not contact(one, other)


@pytest.mark.parametrize(
    ("model", "size", "turn_deg", "corners"),
    [
        ("", (0.4, 0.4, 1.0), 0.0, 4),  # a face
        ("", (0.4, 0.4, 1.0), 4.0, 4),  # within the slack
        ("", (0.4, 0.4, 1.0), 6.0, 2),  # an edge
        ("can", (0.1, 0.1, 0.2), 0.0, 8),  # a disc, as an octagon
        ("can", (0.1, 0.1, 0.2), 20.0, 1),  # a point of its rim
        ("can", (0.1, 0.1, 0.2), 90.0, 2),  # a line of its side
        ("ball", (0.2, 0.2, 0.2), 30.0, 1),
    ],
)
def test_the_face_in_a_direction(model, size, turn_deg, corners):
    half = math.radians(turn_deg) / 2
    turn = (math.cos(half), 0.0, math.sin(half), 0.0)
    (part,) = solid_of(thing("thing1", (1.0, 2.0, 3.0), model, size=size, turn=turn)).parts
    found = find_face(part, (0.0, 0.0, -1.0), math.sin(math.radians(5.0)))
    assert len(found) == corners
    assert min(z for _, _, z in found) == pytest.approx(part.low[2], abs=1e-6)
    assert max(z for _, _, z in found) <= part.low[2] + 0.4 * math.sin(math.radians(5.0))


def test_the_outline_of_a_mesh_has_all_its_corners():
    """An octagon that is not regular, with two corners that are furthest in the same direction."""
    corners = [
        (-0.9, -0.3),
        (-0.5, -0.5),
        (0.5, -0.5),
        (0.9, -0.3),
        (0.9, 0.3),
        (0.5, 0.5),
        (-0.5, 0.5),
        (-0.9, 0.3),
    ]
    points = tuple((x, y, z) for x, y in corners for z in (-0.02, 0.02))
    assert set(make_convex((0.0, 0.0, 0.7), (), (), points).projection) == set(corners)
    many = [(math.cos(k / 8), math.sin(k / 8), z) for k in range(50) for z in (-0.1, 0.1)]
    assert len(make_convex((0.0, 0.0, 0.0), (), (), tuple(many)).projection) <= 16


def test_the_underside_of_a_slope_is_where_the_line_enters_it():
    """A board of 2 m by 1 m by 4 cm that rises by 45 degrees along x."""
    r = math.sqrt(0.5)
    board = make_convex((0.0, 0.0, 2.0), ((r, 0.0, r), (0.0, 0.5, 0.0), (-0.02 * r, 0.0, 0.02 * r)), ())
    half = 0.02 / r
    assert board.find_heights((0.3, 0.1)) == pytest.approx((2.3 - half, 2.3 + half))
    assert board.find_heights((-0.5, 0.0)) == pytest.approx((1.5 - half, 1.5 + half))
    assert box((0.0, 0.0, 0.5), (0.2, 0.2, 0.1), 0.3).find_heights((0.0, 0.0)) == pytest.approx((0.5, 0.6))


KINDS = ("box", "ball", "cylinder", "capsule", "hull")
DIRECTIONS = [
    (math.cos(k * 2.4) * math.sqrt(1 - z * z), math.sin(k * 2.4) * math.sqrt(1 - z * z), z)
    for k in range(240)
    for z in [1 - (2 * k + 1) / 240]
]


def random_part(dice, kind):
    """Return a part of any shape and orientation; some are upright."""
    w, x, y, z = (dice.gauss(0, 1) for _ in range(4)) if dice.random() < 0.7 else (1.0, 0.0, 0.0, 0.0)
    length = math.sqrt(w * w + x * x + y * y + z * z)
    w, x, y, z = w / length, x / length, y / length, z / length
    axes = (
        (1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
        (2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
        (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)),
    )
    a, b, c = (tuple(dice.choice([0.05, 0.2, 0.5]) * along for along in axis) for axis in axes)
    radius = dice.choice([0.05, 0.2])
    sphere = tuple(tuple(radius * along for along in axis) for axis in axes)
    centre = tuple(dice.uniform(-0.6, 0.6) for _ in range(3))
    if kind == "hull":
        points = tuple(tuple(dice.uniform(-0.4, 0.4) for _ in range(3)) for _ in range(dice.choice([4, 8])))
        return make_convex(centre, (), (), points)
    straight, round_ = {
        "box": ((a, b, c), ()),
        "ball": ((), sphere),
        "cylinder": ((c,), (a, b)),
        "capsule": ((c,), sphere),
    }[kind]
    return make_convex(centre, straight, round_)


def dot(one, other):
    return sum(p * q for p, q in zip(one, other, strict=True))


def reach(part, n):
    """Return how far a part reaches in a direction: its support function."""
    return (
        dot(n, part.centre)
        + sum(abs(dot(n, v)) for v in part.straight)
        + math.hypot(*(dot(n, v) for v in part.round))
        + max((dot(n, point) for point in part.points), default=0.0)
    )


def apart(one, other, n):
    """Return how far one part is above another along a direction."""
    return -reach(one, tuple(-k for k in n)) - reach(other, n)


def random_point(dice, part):
    """Return a point in a part."""
    point = part.centre
    shares = [dice.uniform(-1, 1) for _ in part.straight]
    for share, v in zip(shares, part.straight, strict=True):
        point = tuple(p + share * q for p, q in zip(point, v, strict=True))
    shares = [dice.gauss(0, 1) for _ in part.round]
    for share, v in zip(shares, part.round, strict=True):
        point = tuple(p + share / math.hypot(*shares) * q for p, q in zip(point, v, strict=True))
    weights = [dice.random() for _ in part.points]
    for weight, v in zip(weights, part.points, strict=True):
        point = tuple(p + weight / sum(weights) * q for p, q in zip(point, v, strict=True))
    return point


def is_in(part, point):
    return all(dot(n, point) <= reach(part, n) + 1e-6 for n in DIRECTIONS)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("other_kind", KINDS)
def test_two_parts_are_nowhere_farther_apart_than_along_the_normal(kind, other_kind):
    dice = random.Random(kind + other_kind)
    for _ in range(4):
        one, other = random_part(dice, kind), random_part(dice, other_kind)
        found = contact(one, other)
        assert math.hypot(*found.normal) == pytest.approx(1.0)
        tolerance = 5e-3 * (math.dist(one.centre, other.centre) + 1.5)
        furthest = max(apart(one, other, n) for n in DIRECTIONS)
        assert furthest <= found.distance + tolerance
        # The distance of two boxes beside each other's edges is that of their edges.
        assert found.distance == pytest.approx(apart(one, other, found.normal), abs=1e-9)
        assert contact(other, one).distance == pytest.approx(found.distance, abs=tolerance)
        for most in (found.distance - 0.1, found.distance + 0.1):
            bounded = contact(one, other, most).distance
            assert min(most, found.distance) - 1e-9 <= bounded <= found.distance + 1e-9


@pytest.mark.parametrize("kind", KINDS)
def test_bounds_outline_and_heights_of_a_part(kind):
    dice = random.Random(kind)
    for _ in range(12):
        part = random_part(dice, kind)
        for k in range(3):
            axis = tuple(float(k == i) for i in range(3))
            back = tuple(-along for along in axis)
            assert (part.low[k], part.high[k]) == pytest.approx((-reach(part, back), reach(part, axis)))
        if not part.has_flat_top:
            assert is_in(part, (*part.lowest, part.low[2]))
        if not part.round:
            for k in range(8):
                nx, ny = math.cos(k * math.pi / 4), math.sin(k * math.pi / 4)
                furthest = max(nx * x + ny * y for x, y in part.projection)
                assert furthest == pytest.approx(reach(part, (nx, ny, 0.0)))
        for _ in range(20):
            x, y, z = random_point(dice, part)
            low, high = part.find_heights((x, y))
            assert low - 1e-9 <= z <= high + 1e-9
            if kind == "box":
                assert is_in(part, (x, y, low))
                assert is_in(part, (x, y, high))
        assert part.low[2] <= part.lowest_top <= part.high[2]


@pytest.mark.parametrize("kind", KINDS)
def test_a_translated_part_equals_one_that_was_made_there(kind):
    dice = random.Random(kind)
    for _ in range(5):
        part, by = random_part(dice, kind), (0.3, -0.2, 1.1)
        centre = tuple(p + q for p, q in zip(part.centre, by, strict=True))
        moved, made = translate(part, by), make_convex(centre, part.straight, part.round, part.points)
        assert (moved.has_flat_top, moved.is_square) == (made.has_flat_top, made.is_square)
        assert (*moved.low, *moved.high) == pytest.approx((*made.low, *made.high))
        assert moved.lowest == pytest.approx(made.lowest)
        assert moved.lowest_top == pytest.approx(made.lowest_top)
        assert [x for corner in moved.projection for x in corner] == pytest.approx(
            [x for corner in made.projection for x in corner]
        )
        x, y, _ = centre
        assert moved.find_heights((x, y)) == pytest.approx(made.find_heights((x, y)))
        assert (moved.upright_projection is None) == (made.upright_projection is None)


@pytest.mark.parametrize("yaw", [0.0, 0.5])
@pytest.mark.parametrize(
    ("at", "is_over"),
    [
        ((0.0, 0.0, 0.3), True),
        ((0.0, 0.0, 0.5), True),
        ((0.0, 0.0, 0.1), False),  # deep inside
        ((0.0, 0.0, -0.3), False),
        ((0.19, 0.0, 0.3), True),
        ((0.3, 0.0, 0.3), False),
        ((0.0, -0.3, 0.3), False),
    ],
)
def test_a_part_is_over_a_flat_top_with_its_lowest_point(yaw, at, is_over):
    table, ball = (
        box((0.0, 0.0, 0.0), (0.4, 0.4, 0.3), yaw),
        solid_of(thing("ball1", at, "ball", size=(0.1, 0.1, 0.1))),
    )
    (upper,) = ball.parts
    assert over_flat_top(upper, table) == is_over
    assert not over_flat_top(table, upper)


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_overlapping_boxes_are_moved_apart_along_the_shallowest_axis(axis, side):
    offset = [0.02, -0.03, 0.01]
    offset[axis] = side * 0.35
    one, other = box(tuple(offset), (0.4, 0.4, 0.4), 0.0), box((0.0, 0.0, 0.0), (0.4, 0.4, 0.4), 0.0)
    found = contact(one, other)
    assert found.distance == pytest.approx(-0.05)
    assert found.normal == pytest.approx([side * (k == axis) for k in range(3)])


@pytest.mark.parametrize("radii", [(0.3, 0.3), (0.3, 0.1)])
@pytest.mark.parametrize("turn", [0.0, 0.4])
def test_the_outline_of_an_upright_cylinder_has_the_area_of_its_disc(radii, turn):
    cos, sin = math.cos(turn), math.sin(turn)
    a, b = (radii[0] * cos, radii[0] * sin, 0.0), (-radii[1] * sin, radii[1] * cos, 0.0)
    for round_ in ((a, b), (b, a)):
        part = make_convex((1.0, 2.0, 0.5), ((0.0, 0.0, 0.5),), round_)
        assert len(part.projection) == 8
        assert area(part.projection) == pytest.approx(math.pi * radii[0] * radii[1])
