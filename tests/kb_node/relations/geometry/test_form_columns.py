"""Forms as arrays equal single forms."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

from semmap.nodes.kb_node.relations.geometry.form_columns import Extents, FormColumns
from semmap.nodes.kb_node.relations.geometry.forms import form_of
from semmap.ontology.model_shapes import own_size_m, shapes
from semmap.schemas.entities import orientation_from_yaw

MODELS = [
    "table",
    "chair",
    "cup",
    "bowl",
    "bottle",
    "bookshelf",
    "fridge",
    "box",
    "unheard of",
    "ball",
    "sofa",
]
UPRIGHT = (1.0, 0.0, 0.0, 0.0)


def quaternion(rng):
    parts = [rng.gauss(0.0, 1.0) for _ in range(4)]
    length = math.hypot(*parts)
    return tuple(part / length for part in parts)


def some(count=60):
    """Return forms of every model: original and stretched, upright, rotated, tilted and overturned."""
    rng = random.Random(4)
    ways = [
        UPRIGHT,
        *(orientation_from_yaw(n * math.pi / 2) for n in (1, 2, 3)),
        orientation_from_yaw(0.3),
        (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0),
        (math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0),
        (0.0, 1.0, 0.0, 0.0),
    ]
    found = []
    for _ in range(count):
        model = rng.choice(MODELS)
        own = own_size_m(model) or (0.3, 0.2, 0.5)
        size = tuple(side * rng.choice((1.0, 1.0, rng.uniform(0.5, 2.0))) for side in own)
        found.append(form_of(model, size, rng.choice([*ways, quaternion(rng)])))
    return found


FORMS = some()


def test_extents_of_forms():
    for columns in (Extents(FORMS), FormColumns(FORMS)):
        assert columns.bounds.tolist() == [list(form.bounds) for form in FORMS]
        assert columns.top.tolist() == [form.top for form in FORMS]
        assert columns.lowest_corner.tolist() == [form.lowest_corner for form in FORMS]
        assert columns.bottoms().tolist() == [form.bottom for form in FORMS]


def test_properties_of_forms():
    columns = FormColumns(FORMS)
    assert columns.volume.tolist() == [form.volume for form in FORMS]
    assert columns.bottom.tolist() == [form.bottom for form in FORMS]
    assert columns.is_level.tolist() == [form.is_level for form in FORMS]
    for row, form in enumerate(FORMS):
        upright = abs(form.rotation[2][2] - 1.0) < 1e-9
        assert bool(columns.is_plumb[row]) is upright
        assert bool(columns.is_square[row]) is (upright and form.is_square)
        if upright:
            u, v = columns.u[row], columns.v[row]
            assert np.allclose([-u - v, u - v, u + v, v - u], form.outline)


def test_parts_equal_those_of_each_form():
    columns = FormColumns(FORMS)
    parts = columns.parts
    for row, form in enumerate(FORMS):
        assert parts.count[row] == len(form.parts)
        rows = slice(parts.first[row], parts.first[row] + parts.count[row])
        found = sorted(zip(parts.low[rows].tolist(), parts.high[rows].tolist(), strict=True))
        assert found == sorted((list(part.low), list(part.high)) for part in form.parts)


def test_the_lowest_parts_are_within_the_base():
    columns = FormColumns(FORMS)
    for row, form in enumerate(FORMS):
        if not form.parts:
            continue
        x0, y0, x1, y1 = columns.base[row]
        assert all(x0 - 1e-9 <= x <= x1 + 1e-9 and y0 - 1e-9 <= y <= y1 + 1e-9 for x, y in form.base)
        on = [part for part in form.parts if part.low[2] <= form.bottom + 0.0005]
        if (footing := columns.footing[row]) >= 0:
            assert columns.parts.low[footing, 2] == form.bottom
            assert len(on) == 1


def test_hollows_equal_those_of_the_transformed_model():
    columns = FormColumns(FORMS)
    hollows = columns.hollows
    for row, form in enumerate(FORMS):
        interiors = form.shape.interiors
        assert hollows.count[row] == len(interiors)
        stretch = np.array(form.size) / np.array(form.shape.size_m)
        for n, hollow in enumerate(interiors, start=hollows.first[row]):
            low, high = stretch * hollow.low, stretch * hollow.high
            assert (hollows.floor[n], hollows.lid[n]) == pytest.approx((low[2], high[2]))
            for side, along in ((hollows.u[n], 0), (hollows.v[n], 1)):
                half = np.zeros(3)
                half[along] = (high - low)[along] / 2
                assert np.allclose(side, form.turned(tuple(half))[:2])
            middle = (*((low + high) / 2)[:2], 0.0)
            assert np.allclose(hollows.centre[n], form.turned(middle)[:2])


def test_some_models_have_hollows_and_parts():
    """Otherwise the tests above would be empty."""
    columns = FormColumns(FORMS)
    assert columns.hollows.count.sum() > 5
    assert columns.parts.is_disc.sum() > 5
    assert {"table", "bowl"} <= shapes().keys()


@pytest.mark.parametrize(
    ("turn", "level"),
    [(UPRIGHT, True), (orientation_from_yaw(0.7), True), ((math.cos(0.2), math.sin(0.2), 0.0, 0.0), False)],
)
def test_a_box_has_a_flat_top_and_no_lowest_point_only_while_it_is_level(turn, level):
    columns = FormColumns([form_of("box", (0.4, 0.2, 0.6), turn)])
    parts = columns.parts
    assert np.isfinite(parts.centre[0]).all() == level
    if level:
        assert abs(parts.u[0][0] * parts.v[0][1] - parts.u[0][1] * parts.v[0][0]) == pytest.approx(
            0.02, rel=0.01
        )


def test_the_order_of_forms_does_not_matter():
    order = random.Random(1).sample(range(len(FORMS)), len(FORMS))
    shuffled, straight = FormColumns([FORMS[i] for i in order]), FormColumns(FORMS)
    for name in ("bounds", "top", "bottom", "base", "volume", "is_square", "u", "v"):
        assert np.array_equal(getattr(shuffled, name), getattr(straight, name)[order]), name
