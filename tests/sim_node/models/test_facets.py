import math

import numpy as np
import pytest

from semmap.nodes.sim_node.models.facets import facets, surface_of
from semmap.nodes.sim_node.models.library import build
from semmap.nodes.sim_node.models.parts import Mesh, Part, Role, Shape, about, ball, box, pill, rod
from semmap.nodes.sim_node.models.variety_table import KINDS

RED = (1.0, 0.0, 0.0)
TILTED = about("x", 0.7)
TETRAHEDRON = Mesh(
    "t",
    np.array([(-1, -1, -1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)], dtype=float),
    np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)], dtype=np.int32),
)
PARTS = {
    "box": (box((0.4, 0.2, 0.6), (1, 2, 3), RED, TILTED), 0.4 * 0.2 * 0.6),
    "ball": (ball((0.4, 0.2, 0.6), (1, 2, 3), RED, TILTED), 4 / 3 * math.pi * 0.2 * 0.1 * 0.3),
    "rod": (rod(0.1, 0.5, (1, 2, 3), RED, TILTED), math.pi * 0.01 * 0.5),
    "pill": (pill(0.1, 0.5, (1, 2, 3), RED, TILTED), math.pi * 0.01 * 0.3 + 4 / 3 * math.pi * 0.001),
    "mesh": (Part(Shape.MESH, (1, 1, 1), (1, 2, 3), RED, TILTED, mesh=TETRAHEDRON), 8 / 6),
}


@pytest.mark.parametrize("name", PARTS)
def test_a_surface_is_closed_faces_outwards_and_holds_the_volume(name):
    part, volume = PARTS[name]
    points, normals, triangles = facets(part)
    corners = points[triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert across.sum(axis=0) == pytest.approx((0, 0, 0), abs=1e-9)  # closed
    assert np.einsum("ij,ij->", corners.mean(axis=1), across) / 6 == pytest.approx(volume, rel=0.1)
    real = np.linalg.norm(across, axis=1) > 1e-9
    facing = np.einsum("ij,ikj->ik", across, normals[triangles])[real]
    assert (facing > 0).all()
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0)


@pytest.mark.parametrize("name", ["box", "ball", "rod", "pill"])
def test_a_surface_is_where_its_part_is(name):
    part, _ = PARTS[name]
    points = facets(part).points
    assert (points.max(axis=0) + points.min(axis=0)) / 2 == pytest.approx(part.centre, abs=0.01)
    assert (points.max(axis=0) - points.min(axis=0)) / 2 == pytest.approx(part.reach(), rel=0.06)


@pytest.mark.parametrize("name", KINDS)
def test_every_model_has_a_surface_of_its_size(name):
    model = build(name, None)
    surface = surface_of(model)
    points = np.frombuffer(surface.points, "<f4").reshape(-1, 3)
    triangles = np.frombuffer(surface.triangles, "<u4")
    assert len(surface.normals) == len(surface.points) == 4 * len(surface.colours)
    assert triangles.max() == len(points) - 1
    assert points[:, 2].min() == pytest.approx(0.0, abs=0.02)
    assert len(surface.points) < 100_000


def test_a_surface_has_the_colours_of_its_parts():
    colours = np.frombuffer(surface_of(build("apple", None)).colours, "u1").reshape(-1, 3)
    assert any((red > 150) and green < 80 for red, green, _ in colours.tolist())


@pytest.mark.parametrize("name", ["fridge", "oven", "drawer", "book"])
def test_a_joint_moves_the_points_of_its_parts(name):
    model = build(name, None)
    surface = surface_of(model)
    points = np.frombuffer(surface.points, "<f4").reshape(-1, 3)
    assert [leaf.joint for leaf in surface.leaves] == [leaf.joint.name for leaf in model.leaves]
    for leaf, own in zip(surface.leaves, model.leaves, strict=True):
        moved = [
            facets(part).points
            for part in model.parts
            if part.role is not Role.COLLISION and part.joint == own.joint
        ]
        assert points[leaf.first : leaf.first + leaf.count] == pytest.approx(np.concatenate(moved), abs=1e-5)
