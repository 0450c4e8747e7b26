"""Solids are closed, turned outwards, and as large as was asked for."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh

from semmap.nodes.training.scenes.solids import full, hollow, lathe, lump, smooth, tube


def volume_of(solid) -> float:
    """Of a closed surface; negative where it is inside out."""
    mesh = trimesh.Trimesh(solid.vertices, solid.faces, process=False)
    assert mesh.is_watertight
    return float(mesh.volume)


def test_a_lathe_makes_a_cylinder_that_is_closed_and_faces_outwards():
    solid = lathe(full([(0.05, 0.0), (0.05, 0.2)]), slices=200)
    assert volume_of(solid) == pytest.approx(math.pi * 0.05**2 * 0.2, rel=1e-3)
    assert solid.vertices.min(axis=0) == pytest.approx((-0.05, -0.05, 0.0))


def test_a_hollow_vessel_holds_what_its_walls_leave():
    outside = [(0.05, 0.0), (0.05, 0.05), (0.05, 0.1)]
    walls = volume_of(lathe(hollow(outside, 0.01, 0.02), slices=200))
    assert walls == pytest.approx(math.pi * (0.05**2 * 0.1 - 0.04**2 * 0.08), rel=1e-3)


def test_a_tube_follows_its_path_and_faces_outwards():
    path = np.array([(0.0, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.2, 0.0)])
    solid = tube(path, 0.01, slices=100)
    assert volume_of(solid) == pytest.approx(math.pi * 0.01**2 * 0.2, rel=5e-3)
    bow = np.linspace(0.0, 1.5 * math.pi, 20)
    assert volume_of(tube(0.1 * np.column_stack([np.cos(bow), np.sin(bow), 0.0 * bow]), 0.02)) > 0.0


@pytest.mark.parametrize("square", [1.0, 0.5, 0.25])
def test_a_lump_has_its_extents_and_is_fuller_the_squarer_it_is(square):
    solid = lump(0.1, 0.2, 0.06, square=square)
    assert solid.vertices.min(axis=0) == pytest.approx((-0.05, -0.1, 0.0), abs=1e-9)
    assert solid.vertices.max(axis=0) == pytest.approx((0.05, 0.1, 0.06), abs=1e-9)
    assert volume_of(solid) > (0.45 if square == 1.0 else 0.6) * 0.1 * 0.2 * 0.06


def test_what_is_smoothed_keeps_its_ends_and_cuts_its_corners():
    path = np.array(smooth([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)], 3))
    assert path[0] == pytest.approx((0.0, 0.0))
    assert path[-1] == pytest.approx((1.0, 1.0))
    assert np.linalg.norm(path - (1.0, 0.0), axis=1).min() > 0.15


def test_a_lip_is_drawn_out_at_the_rim_and_nowhere_else():
    plain = lathe(full([(0.05, 0.0), (0.05, 0.05), (0.05, 0.1)]))
    lipped = plain.lipped(0.02, 0.5, 0.6)
    moved = lipped.vertices - plain.vertices
    assert moved[:, 1].max() == pytest.approx(0.02, rel=0.02)
    assert (moved[plain.vertices[:, 2] < 0.06] == 0.0).all()


def test_lumps_differ_and_stay_near_what_they_were():
    ball = lump(0.1, 0.1, 0.1)
    one, other = (ball.lumpy(0.1, np.random.default_rng(seed)).vertices for seed in (0, 1))
    assert not np.allclose(one, other)
    assert np.linalg.norm(one - ball.vertices, axis=1).max() < 0.1 * 0.05 + 1e-9
