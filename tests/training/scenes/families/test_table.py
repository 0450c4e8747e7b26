"""Each time a family is drawn, another thing comes, upon the ground, of a size that such things have."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.sim_node.models.library import assemble
from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.sim_node.models.parts import bounds
from semmap.nodes.training.scenes.families.table import FAMILIES, drawn
from semmap.nodes.training.scenes.simulated_scenes import foreign_class
from semmap.nodes.training.taxonomy import hierarchy

SMALLEST_M, LARGEST_M = 0.015, 0.6
KINDS = sorted({family.kind for family in FAMILIES})


def test_every_family_is_of_a_class_that_the_tbox_has():
    known = {above for classes in hierarchy().values() for above in classes} | set(hierarchy())
    for kind in KINDS:
        told = foreign_class(kind)
        assert kind in MODELS if told is None else told[1] in known


@pytest.mark.parametrize("number", range(len(FAMILIES)))
def test_no_two_of_a_family_are_the_same_and_all_are_of_a_likely_size(number):
    rng = np.random.default_rng(number)
    sizes = []
    for _ in range(30):
        parts = drawn(FAMILIES[number], (0.5, 0.4, 0.3), rng)
        assert all(np.isfinite(part.mesh.vertices).all() for part in parts if part.mesh is not None)
        low, high = bounds(parts)
        size = high - low
        assert (size > SMALLEST_M / 2).all()
        assert size.max() > SMALLEST_M
        assert (size < LARGEST_M).all()
        assert assemble("thing", parts, 0.4).size_m == pytest.approx(size)
        sizes.append(tuple(size.round(4)))
    assert len(set(sizes)) > 20


def test_meshes_have_names_of_their_own():
    rng = np.random.default_rng(0)
    keys = [
        part.mesh.key for _ in range(20) for part in drawn(FAMILIES[0], (0.5, 0.4, 0.3), rng) if part.mesh
    ]
    assert len(set(keys)) == len(keys)
