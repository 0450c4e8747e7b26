"""Distances of axis-aligned boxes and of upright parts equal those of the search."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from semmap.nodes.kb_node.relations.geometry.convex import _search_contact, contact, find_face, make_convex
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
