import json
import math
from itertools import product as product_of

import mujoco
import numpy as np
import pytest

from semmap.nodes.sim_node.models.forms import GREY, hollow_box, slab
from semmap.nodes.sim_node.models.library import assemble, build
from semmap.nodes.sim_node.models.parts import (
    UPRIGHT,
    about,
    ball,
    box,
    mesh,
    pill,
    product,
    rod,
    visual,
    with_cavity,
)
from semmap.nodes.sim_node.models.spaces import _cut, shape_of
from semmap.nodes.sim_node.models.variety_table import KINDS
from semmap.nodes.sim_node.models.write_shapes import as_json, library_shapes
from semmap.nodes.sim_node.physics.build import add_part
from semmap.ontology import MODEL_SHAPES_JSON


def heights(model):
    return [round(surface.height, 2) for surface in shape_of(build(model, None)).surfaces]


@pytest.mark.long
def test_the_file_is_what_the_models_say():
    assert MODEL_SHAPES_JSON.read_text() == as_json(library_shapes()), "make shapes"


def test_the_file_is_what_some_models_of_each_kind_say():
    text = MODEL_SHAPES_JSON.read_text()
    assert json.loads(text).keys() == {"", *KINDS}
    for name in (
        "",
        "table",
        "bookshelf",
        "fridge",
        "chair",
        "bowl",
        "cup",
        "apple",
        "door",
        "clock",
        "pot",
        "can",
    ):
        (row,) = as_json({name: shape_of(build(name, None))}).splitlines()[1:-1]
        assert row in text, "make shapes"


@pytest.mark.parametrize(
    ("model", "expected"),
    [("table", [0.75]), ("bookshelf", [1.8, 1.44, 1.09, 0.73, 0.38, 0.03]), ("chair", [0.88, 0.67, 0.45])],
)
def test_surfaces_are_where_a_person_would_put_things(model, expected):
    assert heights(model) == pytest.approx(expected, abs=0.02)


def test_hollows():
    (inside,) = shape_of(build("bowl", None)).interiors
    assert inside.open
    assert inside.low[2] < 0.02
    assert shape_of(build("table", None)).interiors == ()
    assert shape_of(build("apple", None)).interiors == ()


def test_a_plain_box_carries_with_all_of_its_top():
    (top,) = shape_of(build("", (0.4, 0.6, 0.3))).surfaces
    assert top.height == pytest.approx(0.3)
    assert top.high[0] - top.low[0] == pytest.approx(0.4, abs=0.02)
    assert top.fill == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("model", "behind"),
    [
        ("fridge", {("door",), ("freezer",)}),
        ("cabinet", {("left", "right")}),
        ("wardrobe", {("left", "right")}),
        ("oven", {("door",)}),
        ("washing_machine", {("door",)}),
        ("bin", {("lid",)}),
        ("cardboard_box", {("left", "right")}),
        ("suitcase", {("lid",)}),
        ("drawer", {("drawer_1",), ("drawer_2",), ("drawer_3",), ("drawer_4",)}),
        ("bowl", {()}),
    ],
)
def test_a_hollow_says_what_closes_it(model, behind):
    assert {room.behind for room in shape_of(build(model, None)).interiors} == behind


@pytest.mark.parametrize(
    "model",
    [
        "bag", "bowl", "bucket", "cup", "flower_pot", "glass", "jar", "pitcher", "pot", "small_glass",
        "toilet", "vase", "wine_glass",
    ],
)  # fmt: skip
def test_an_open_vessel_has_an_open_interior(model):
    (room,) = shape_of(build(model, None)).interiors
    assert room.open
    assert not room.behind
    assert room.filled == (model not in ("bowl", "bucket"))


@pytest.mark.parametrize(
    "model",
    [
        "backpack", "bottle", "can", "carton", "case", "drink_can", "flat_bottle", "flat_can", "kettle",
        "spray_bottle", "teapot", "wide_can", "wine_bottle",
    ],
)  # fmt: skip
def test_a_closed_vessel_has_a_sealed_interior(model):
    (room,) = shape_of(build(model, None)).interiors
    assert room.is_sealed
    assert not room.behind


@pytest.mark.parametrize("name", sorted(KINDS))
def test_a_cavity_is_within_its_part(name):
    model = build(name, None)
    rooms = shape_of(model).interiors if any(part.cavity for part in model.parts) else ()
    for part in (part for part in model.parts if part.cavity):
        low, high = np.asarray(part.centre) - part.reach(), np.asarray(part.centre) + part.reach()
        (room,) = rooms
        assert (np.less(low, room.low)).all()
        assert (np.less_equal(room.high, high)).all()
        assert (np.less(room.low, room.high)).all()


def test_a_cavity_leaves_a_wall_and_the_surface_of_its_part():
    solid = rod(0.1, 0.3, (0.0, 0.0, 0.15), RED)
    (open_room,) = shape(with_cavity(solid, is_open=True)).interiors
    assert open_room.open
    assert open_room.low == pytest.approx((-0.094, -0.094, 0.006))
    assert open_room.high == pytest.approx((0.094, 0.094, 0.3))
    assert open_room.fill == pytest.approx(math.pi / 4)
    assert open_room.round
    (closed,) = shape(with_cavity(solid, is_open=False)).interiors
    assert not closed.open
    assert closed.high[2] == pytest.approx(0.294)
    (shallow,) = shape(with_cavity(solid, is_open=True, floor=0.5)).interiors
    assert shallow.low[2] == pytest.approx(0.156)
    (thin,) = shape(with_cavity(rod(0.01, 0.3, (0.0, 0.0, 0.15), RED), is_open=True)).interiors
    assert thin.low[0] == pytest.approx(-0.009)
    assert shape(with_cavity(solid, is_open=True)).surfaces == shape(solid).surfaces


@pytest.mark.parametrize("model", ["drawer", "desk"])
def test_a_drawer_carries_what_is_in_its_tray(model):
    shape = shape_of(build(model, None))
    for leaf in shape.leaves:
        (tray,) = leaf.interiors
        (room,) = (room for room in shape.interiors if leaf.name in room.behind)
        assert all(low >= least - 0.02 for low, least in zip(tray.low, room.low, strict=True))
        assert all(high <= most + 0.02 for high, most in zip(tray.high, room.high, strict=True))
        assert tray.high[2] == pytest.approx(room.high[2])
        assert any(shape.surfaces[k].height == pytest.approx(tray.low[2], abs=0.01) for k in leaf.surfaces)


RED = (1.0, 0.0, 0.0)
TURNS = (UPRIGHT, about("x", 0.5), product(about("z", 0.7), about("y", 1.1)), about("y", math.pi / 2))


def pieces(turn):
    at = (0.1, -0.05, 0.3)
    return [
        box((0.4, 0.3, 0.5), at, RED, turn),
        ball((0.4, 0.3, 0.5), at, RED, turn),
        rod(0.2, 0.5, at, RED, turn),
        pill(0.12, 0.6, at, RED, turn),
    ]


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("number", range(4), ids=["box", "ball", "rod", "pill"])
def test_upright_lines_enter_and_leave_a_part_at_its_surface(number, turn):
    """Compared with MuJoCo's rays from above and below."""
    part = pieces(turn)[number]
    spec = mujoco.MjSpec()
    add_part(spec.worldbody.add_body(), part)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    xs, ys = np.linspace(-0.31, 0.43, 7), np.linspace(-0.37, 0.33, 6)
    enter, leave = _cut(part, xs, ys)
    assert (~np.isnan(enter)).sum() > 2
    for (i, x), (j, y) in product_of(enumerate(xs), enumerate(ys)):
        low, high = (_ray(model, data, x, y, side) for side in (-1.0, 1.0))
        assert np.isnan(enter[i, j]) == np.isnan(leave[i, j]) == (low is None)
        if low is not None:
            assert enter[i, j] == pytest.approx(low, abs=1e-6)
            assert leave[i, j] == pytest.approx(high, abs=1e-6)


def _ray(model, data, x, y, side):
    """Return the height at which a vertical line from below (-1) or above (1) first hits the geometry."""
    geom = np.array([-1], np.int32)
    start, way = np.array([x, y, 5.0 * side]), np.array([0.0, 0.0, -side])
    distance = mujoco.mj_ray(model, data, start, way, None, 1, -1, geom)
    return None if distance < 0 else 5.0 * side - side * distance


def test_a_line_through_a_mesh_is_cut_by_its_hull():
    faces = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)], dtype=np.int32)
    wedge = mesh(np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float), faces, RED)
    enter, leave = _cut(wedge, np.array([0.2, 0.9]), np.array([0.3, 0.9]))
    assert enter[0, 0] == pytest.approx(0.0)
    assert leave[0, 0] == pytest.approx(0.5)
    assert np.isnan(enter[1, 1])


def shape(*parts):
    return shape_of(assemble("it", list(parts), 1.0))


def walled(height, *, lid=False):
    walls = hollow_box(1.0, 1.2, height, 0.05, RED)
    return [*walls, *([slab(1.0, 1.2, height, height + 0.05, RED)] if lid else [])]


def test_a_hollow_box_holds_and_is_open_until_it_has_a_lid():
    (inside,) = shape(*walled(0.6)).interiors
    assert inside.open
    assert inside.low == pytest.approx((-0.45, -0.55, 0.05), abs=0.02)
    assert inside.high == pytest.approx((0.45, 0.55, 0.6), abs=0.02)
    assert inside.fill == pytest.approx(1.0)
    (closed,) = shape(*walled(0.6, lid=True)).interiors
    assert not closed.open
    assert closed.high[2] == pytest.approx(0.6, abs=1e-6)  # to its lid, not to a cell's end
    assert closed.low[2] == pytest.approx(0.05, abs=1e-6)


def test_what_lacks_a_wall_or_its_floor_holds_nothing():
    for missing in range(5):
        parts = walled(0.6)
        del parts[missing]
        assert shape(*parts).interiors == ()


def test_what_is_only_seen_is_a_wall_too_and_carries_nothing():
    parts = walled(0.6)
    (inside,) = shape(slab(1.0, 1.2, 0.0, 0.05, RED), *visual(parts[1:])).interiors
    assert inside.open
    (top,) = shape(slab(1.0, 1.2, 0.0, 0.05, RED), *visual(slab(0.5, 0.5, 0.05, 0.6, RED))).surfaces
    assert top.height == pytest.approx(0.05)


def test_two_hollows_are_told_apart_and_a_tiny_one_is_none():
    wide = [*walled(0.6), box((0.9, 0.05, 0.55), (0.0, 0.1, 0.325), RED)]
    first, second = shape(*wide).interiors
    assert first.high[1] == pytest.approx(0.075, abs=0.02)
    assert second.low[1] == pytest.approx(0.125, abs=0.02)
    narrow = [*walled(0.6), box((0.9, 1.05, 0.55), (0.0, -0.02, 0.325), RED)]
    assert shape(*narrow).interiors == ()


@pytest.mark.parametrize(("gap_m", "heights"), [(0.05, [0.25, 0.1]), (0.02, [0.22])])
def test_a_board_carries_where_there_is_room_above_it(gap_m, heights):
    lower, upper = slab(1.0, 1.0, 0.0, 0.1, RED), slab(1.0, 1.0, 0.1 + gap_m, 0.2 + gap_m, RED)
    assert [top.height for top in shape(lower, upper).surfaces] == pytest.approx(heights)


def test_parts_that_touch_are_one_solid():
    stack = [slab(1.0, 1.0, 0.0, 0.1, RED), slab(1.0, 1.0, 0.102, 0.2, RED)]
    assert [top.height for top in shape(*stack).surfaces] == pytest.approx([0.2])


def test_levels_that_differ_by_little_are_one_surface_and_steps_are_several():
    def tops(step_m):
        left, right = (
            box((0.5, 1, 0.2), (-0.25, 0, 0.1), RED),
            box((0.5, 1, 0.2 + step_m), (0.25, 0, 0.1 + step_m / 2), RED),
        )
        return [
            (round(top.height, 3), round(top.high[0] - top.low[0], 1)) for top in shape(left, right).surfaces
        ]

    assert len(tops(0.004)) == 1
    assert tops(0.05) == [(0.25, 0.5), (0.2, 0.5)]


def test_a_disc_fills_most_of_its_rectangle_and_a_rim_carries_only_at_the_top():
    (disc,) = shape(rod(0.5, 0.1, (0, 0, 0.05), RED)).surfaces
    assert disc.fill == pytest.approx(math.pi / 4, abs=0.02)
    assert disc.low == pytest.approx((-0.5, -0.5), abs=0.02)
    rim = hollow_box(1.0, 1.0, 0.3, 0.04, RED)
    assert [top.height for top in shape(*rim).surfaces] == pytest.approx([0.3, 0.04])
    post = box((0.1, 0.1, 0.5), (0.0, 0.0, 0.25), RED)
    assert 0.3 not in [round(top.height, 2) for top in shape(*rim, *_board(post)).surfaces]


def _board(post):
    return [post, box((0.6, 0.6, 0.1), (0.0, 0.0, 0.55), RED)]


def test_an_edge_is_too_small_to_carry():
    base, knob = slab(1.0, 1.0, 0.0, 0.1, RED), box((0.1, 0.1, 0.1), (0.3, 0.3, 0.15), RED)
    assert [round(top.height, 3) for top in shape(base, knob).surfaces] == [0.1]
    larger = box((0.2, 0.2, 0.1), (0.3, 0.3, 0.15), RED)
    assert [round(top.height, 3) for top in shape(base, larger).surfaces] == [0.2, 0.1]


def cot(gap_m):
    """Return a floor with bars on all sides, this far apart."""
    places = [(x, y) for x in np.arange(-0.5, 0.51, gap_m) for y in (-0.3, 0.3)]
    places += [(x, y) for x in (-0.5, 0.5) for y in np.arange(-0.3, 0.31, gap_m)]
    bars = [rod(0.006, 0.5, (float(x), float(y), 0.27), GREY) for x, y in places]
    return assemble("cot", [slab(1.02, 0.62, 0.0, 0.02, GREY), *bars], 5.0)


def test_bars_close_together_are_walls():
    (room,) = shape_of(cot(0.1)).interiors
    assert room.low[2] == pytest.approx(0.02)
    assert room.high == pytest.approx((0.5, 0.3, 0.52), abs=0.03)
    assert shape_of(cot(0.2)).interiors == ()


def test_a_thin_floor_is_where_it_is():
    (room,) = shape_of(assemble("drawer", hollow_box(0.6, 0.4, 0.15, 0.003, GREY), 1.0)).interiors
    assert room.low[2] == pytest.approx(0.003)


@pytest.mark.parametrize(("height_m", "is_shallow"), [(0.03, True), (0.1, False)])
def test_a_tray_is_shallow(height_m, is_shallow):
    (room,) = shape_of(assemble("tray", hollow_box(0.4, 0.3, height_m, 0.005, GREY), 1.0)).interiors
    assert room.shallow == is_shallow


def test_a_shallow_room_with_a_lid_is_not_a_tray():
    """A tray below another board is one, but not a flat box that the board closes."""
    parts = hollow_box(0.4, 0.3, 0.03, 0.005, GREY)
    closed = shape_of(assemble("box", [*parts, slab(0.4, 0.3, 0.03, 0.035, GREY)], 1.0))
    cart = shape_of(assemble("cart", [*parts, slab(0.4, 0.3, 0.3, 0.32, GREY)], 1.0))
    assert [room.shallow for shape in (closed, cart) for room in shape.interiors] == [False, True]


def ring(wide, height, rail):
    """Return a floor with four posts and a ring at their tops."""
    half, level = wide / 2, height - rail / 2
    posts = [rod(0.01, height, (x, y, height / 2), GREY) for x in (-half, half) for y in (-half, half)]
    rails = [box((wide, 0.02, rail), (0.0, y, level), GREY) for y in (-half, half)]
    rails += [box((0.02, wide, rail), (x, 0.0, level), GREY) for x in (-half, half)]
    return assemble("ring", [slab(wide + 0.02, wide + 0.02, 0.0, 0.02, GREY), *posts, *rails], 5.0)


def test_a_narrow_ring_holds_what_stands_in_it_down_to_the_floor():
    (room,) = shape_of(ring(0.24, 0.5, 0.03)).interiors
    assert (room.low[2], room.high[2]) == pytest.approx((0.02, 0.5), abs=0.01)


def test_the_canopy_of_a_bed_holds_nothing():
    assert all(room.low[2] > 1.8 for room in shape_of(ring(1.6, 2.0, 0.1)).interiors)
