"""Convex parts as primitives and meshes."""

import math

import numpy as np
import pytest

from semmap.nodes.extern.ros.solids import solids_of
from semmap.ontology.model_shapes import ConvexPart, shapes

BOX, SPHERE, CYLINDER = 1, 2, 3


def matrix(pose):
    q = pose.orientation
    w, x, y, z = q.w, q.x, q.y, q.z
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


def corners_of_box(primitive, pose):
    at = np.array((pose.position.x, pose.position.y, pose.position.z))
    signs = np.stack(np.meshgrid(*[(-0.5, 0.5)] * 3), -1).reshape(-1, 3)
    return at + signs * primitive.dimensions @ matrix(pose).T


@pytest.mark.parametrize("turn", [0.0, 0.7, math.pi, 4.0])
@pytest.mark.parametrize("order", [(0, 1, 2), (1, 0, 2), (2, 1, 0)])
def test_a_box_has_its_corners_whichever_way_it_is_turned(turn, order):
    c, s = math.cos(turn), math.sin(turn)
    sides = np.array([(0.3 * c, 0.3 * s, 0.0), (-0.2 * s, 0.2 * c, 0.0), (0.0, 0.0, 0.1)])
    part = ConvexPart(centre=(1.0, 2.0, 3.0), straight=tuple(tuple(sides[k].tolist()) for k in order))
    made = solids_of([part])
    (found,) = [corners_of_box(*pair) for pair in zip(made.primitives, made.primitive_poses, strict=True)]
    signs = np.stack(np.meshgrid(*[(-1, 1)] * 3), -1).reshape(-1, 3)
    expected = np.array(part.centre) + signs @ sides
    assert sorted(found.round(9).tolist()) == sorted(expected.round(9).tolist())


def test_a_lying_cylinder_points_along_its_axis():
    part = ConvexPart(centre=(0, 0, 0), straight=((0.4, 0, 0),), round=((0, 0.1, 0), (0, 0, 0.1)))
    made = solids_of([part])
    assert made.primitives[0].type == CYLINDER
    assert made.primitives[0].dimensions == pytest.approx([0.8, 0.1])
    assert np.abs(matrix(made.primitive_poses[0])[:, 2]) == pytest.approx([1, 0, 0])


def test_a_ball_and_a_capsule():
    radii = ((0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1))
    ball = solids_of([ConvexPart(centre=(1, 0, 0), round=radii)])
    assert (ball.primitives[0].type, ball.primitives[0].dimensions.tolist()) == (SPHERE, [0.1])
    capsule = solids_of([ConvexPart(centre=(0, 0, 1), straight=((0, 0, 0.5),), round=radii)])
    assert [primitive.type for primitive in capsule.primitives] == [CYLINDER, SPHERE, SPHERE]
    assert [pose.position.z for pose in capsule.primitive_poses] == [1.0, 0.5, 1.5]


def test_a_board_without_thickness_gets_a_millimetre():
    (board,) = solids_of(
        [ConvexPart(centre=(0, 0, 0), straight=((1, 0, 0), (0, 1, 0), (0, 0, 0)))]
    ).primitives
    assert board.dimensions.tolist() == [2.0, 2.0, 0.001]


@pytest.mark.parametrize(
    "part",
    [
        ConvexPart(centre=(0, 0, 0), round=((0.3, 0, 0), (0, 0.2, 0), (0, 0, 0.1))),
        ConvexPart(centre=(0, 0, 0), straight=((0.3, 0.1, 0), (0, 0.2, 0), (0, 0, 0.1))),
        ConvexPart(centre=(0, 0, 0), points=((0, 0, 0), (0.3, 0, 0), (0, 0.2, 0), (0, 0, 0.1))),
    ],
)
def test_any_other_part_is_a_mesh_within_its_bounds(part):
    made = solids_of([part])
    assert not made.primitives
    ((mesh,), (pose,)) = made.meshes, made.mesh_poses
    vertices = np.array([(v.x, v.y, v.z) for v in mesh.vertices])
    assert np.ptp(vertices, axis=0).max() == pytest.approx(0.6 if not part.points else 0.3, rel=0.05)
    assert pose.orientation.w == 1.0
    assert len(mesh.triangles) >= 4


def test_every_part_of_the_library_becomes_something_with_an_extent():
    for shape in shapes().values():
        made = solids_of(shape.parts)
        assert len(made.primitives) == len(made.primitive_poses)
        assert len(made.meshes) == len(made.mesh_poses)
        assert made.primitives or made.meshes
        assert all(primitive.dimensions.min() > 0.0 for primitive in made.primitives)
