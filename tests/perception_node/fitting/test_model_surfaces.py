"""The shipped surfaces of models."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.perception_node.fitting.model_surfaces import load, save, shipped
from semmap.schemas.errors import BadFile
from tests.perception_node.fitting.seen import model


@pytest.mark.parametrize(
    ("class_", "fold"),
    [
        ("Apple", 0),
        ("Bottle", 0),
        ("Bowl", 0),
        ("Book", 2),
        ("Cereals", 2),
        ("Cup", 1),
        ("Laptop", 1),
        ("Iron", 1),
    ],
)
def test_what_is_symmetric_is_said_to_be_so(class_, fold):
    assert model(class_).fold == fold


def test_what_is_drawn_out_is_no_longer_round():
    apple = model("Apple")
    assert apple.scaled(apple.size_m * 1.5).fold == 0
    assert apple.scaled(apple.size_m * [1.5, 1.0, 1.0]).fold == 2


def test_points_are_on_the_box_and_normals_point_outwards():
    for class_, models in shipped().items():
        for surface in models:
            low, high = surface.points.min(axis=0), surface.points.max(axis=0)
            np.testing.assert_allclose(
                high - low, surface.size_m, atol=0.15 * max(surface.size_m), err_msg=class_
            )
            np.testing.assert_allclose(np.linalg.norm(surface.normals, axis=1), 1.0, atol=1e-6)
    ball = model("Ball")
    outwards = ((ball.points - [0, 0, ball.size_m[2] / 2]) * ball.normals).sum(axis=1)
    assert np.mean(outwards > 0) > 0.99


def test_a_model_that_is_laid_down_lies_on_its_support():
    bottle = model("Bottle")
    laid = bottle.rotated(np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]]))
    np.testing.assert_allclose(laid.size_m, bottle.size_m[[0, 2, 1]], atol=0.02)
    assert abs(laid.points[:, 2].min()) < 1e-9


def test_they_are_written_and_read(tmp_path):
    save({"Cup": [model("Cup")], "Box": shipped()["Box"]}, tmp_path / "some.npz")
    found = load(tmp_path / "some.npz")
    assert len(found["Box"]) == len(shipped()["Box"])
    np.testing.assert_allclose(found["Cup"][0].points, model("Cup").points, atol=1e-4)
    assert found["Cup"][0].fold == 1


def test_another_file_is_refused(tmp_path):
    (tmp_path / "bad.npz").write_bytes(b"no archive")
    with pytest.raises(BadFile, match=r"bad\.npz has no valid surfaces"):
        load(tmp_path / "bad.npz")
