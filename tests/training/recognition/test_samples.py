from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.training.recognition.samples import NOTHING, samples_of, true_box
from tests.perception_node.scenes import HEIGHT_M, KINDS, item, shot, shot_of


def test_every_thing_is_a_sample_from_each_side_and_from_both():
    items = [item(kind, kind, (x, y, HEIGHT_M + 0.001), 0.4) for kind, (x, y) in KINDS.items()]
    items.append(item("table", "table", (0.0, 0.0, 0.0), 0.0, (0.8, 1.4, HEIGHT_M)))
    samples = samples_of(shot(), items, scene=1)
    truly = sorted([*KINDS, "table"] * 3)
    as_perception_cuts, as_it_is = np.split(samples.kind, [len(samples) - len(truly)])
    assert sorted(as_it_is) == truly
    assert set(as_perception_cuts) >= {*KINDS, "table"}
    things = samples.kind != NOTHING
    assert (samples.as_modelled == things).all()
    assert np.isfinite(samples.shifts[things]).all()
    assert np.abs(samples.shifts[things]).max() < 1.5


def test_what_is_of_another_make_has_not_the_form_of_our_model():
    cup = replace(item("cup", "cup", (0.0, 0.0, HEIGHT_M + 0.001), 0.4), form=MODELS["can"].parts)
    table = item("table", "table", (0.0, 0.0, 0.0), 0.0, (0.8, 1.4, HEIGHT_M))
    samples = samples_of(shot_of([cup]), [cup, table], scene=1)
    assert set(samples.kind[~samples.as_modelled & (samples.kind != NOTHING)]) == {"cup"}
    assert set(samples.kind[samples.as_modelled]) == {"table"}


def test_the_true_box_of_a_turned_thing():
    box = true_box(item("box", "box", (1.0, 2.0, 0.5), 0.3, (0.2, 0.4, 0.3)), 0.3)
    assert box.size_m == pytest.approx([0.2, 0.4, 0.3], abs=0.002)
    assert box.bottom_m == pytest.approx([1.0, 2.0, 0.5], abs=0.002)
    across = true_box(item("box", "box", (1.0, 2.0, 0.5), 0.3, (0.2, 0.4, 0.3)), 0.3 + np.pi / 2)
    assert across.size_m == pytest.approx([0.4, 0.2, 0.3], abs=0.002)
