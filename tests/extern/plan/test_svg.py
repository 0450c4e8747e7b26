import re
import xml.etree.ElementTree as ET

import pytest

from semmap.nodes.extern.plan.floor import floor_of
from semmap.nodes.extern.plan.svg import draw, drawing
from semmap.schemas.plans import Outline, Plan, PlannedThing
from tests.extern.plan.things import place, thing

SVG = "{http://www.w3.org/2000/svg}"


def drawn(*entities, title="flat", **others):
    return ET.fromstring(drawing(floor_of(entities, **others), title=title, commit=7, stamp_ns=0))


def texts(svg):
    return [element.text for element in svg.iter(f"{SVG}text")]


def outline(svg, kind):
    found = next(p for p in svg.iter(f"{SVG}polygon") if p.get("class") == kind)
    return [tuple(map(float, pair.split(","))) for pair in found.get("points").split()]


def test_lengths_on_paper_are_those_of_the_scale():
    svg = drawn(place("room", (2.0, 1.5), (4.0, 3.0)), thing("table1", at=(1.0, 1.0, 0.0)))
    scale = int(next(t for t in texts(svg) if t.startswith("1 : ")).removeprefix("1 : "))
    xs, ys = zip(*outline(svg, "furniture"), strict=True)
    assert max(xs) - min(xs) == pytest.approx(1000.0 / scale, abs=0.02)
    assert max(ys) - min(ys) == pytest.approx(2000.0 / scale, abs=0.02)
    assert svg.get("width").endswith("mm")
    assert svg.get("viewBox") == f"0 0 {svg.get('width')[:-2]} {svg.get('height')[:-2]}"


def test_an_object_of_several_parts_is_drawn_by_their_outlines():
    parts = tuple(
        Outline(corners=((x0, y0), (x1, y0), (x1, y1), (x0, y1)), low=0.0, high=0.7)
        for x0, y0, x1, y1 in ((0, 0, 2, 1), (0, 1, 1, 2))
    )
    about = {"name": "couch1", "label": "couch", "class_": "Couch", "footprint": (), "parts": parts}
    svg = drawn(thing("couch1", size=(2.0, 2.0, 0.7)), plan=Plan(places=(), things=(PlannedThing(**about),)))
    drawn_as = [p.get("class") for p in svg.iter(f"{SVG}polygon")]
    assert drawn_as == ["furniture edge", "furniture edge", "furniture inside", "furniture inside"]
    scale = int(next(t for t in texts(svg) if t.startswith("1 : ")).removeprefix("1 : "))
    xs, ys = zip(*outline(svg, "furniture edge"), strict=True)
    assert (max(xs) - min(xs)) / (max(ys) - min(ys)) == pytest.approx(2.0, abs=0.01)
    assert max(xs) - min(xs) == pytest.approx(2000.0 / scale, abs=0.02)


def test_north_is_up():
    svg = drawn(thing("south", at=(0, 0, 0)), thing("north", at=(0, 9, 0)))
    by_name = {
        p.find(f"{SVG}title").text: float(p.get("points").split()[0].split(",")[1])
        for p in svg.iter(f"{SVG}polygon")
    }
    assert by_name["north"] < by_name["south"]


def test_every_thing_is_named_on_the_plan_or_in_the_list():
    crowd = [thing(f"cup{i}", at=(0.01 * i, 0, 0.7), size=(0.05, 0.05, 0.1)) for i in range(60)]
    svg = drawn(place("room", (2.0, 1.5), (6.0, 5.0)), *crowd)
    shown = set(texts(svg))
    more = [t for t in shown if re.search(r"^\d+ more objects?$", t)]
    unnamed = int(more[0].split()[0]) if more else 0
    assert sum(f"cup{i}" in shown for i in range(60)) + unnamed == 60
    assert unnamed < 60


def test_markup_in_names_is_text():
    svg = drawn(
        place("room", (0, 0), (4, 4), preferred_reference="<script>alert(1)</script>\x07"),
        title='"><script>alert(2)</script>',
    )
    assert not list(svg.iter(f"{SVG}script"))
    assert '"><script>alert(2)</script>' in texts(svg)
    assert any(t.startswith("<script>alert(1)") for t in texts(svg))


def test_a_door_is_a_gap_as_thick_as_the_wall():
    svg = drawn(
        place("room", (2, 2), (4, 4)), thing("door1", types=("Door",), at=(0, 2, 0), size=(0.06, 0.9, 2))
    )
    xs, ys = zip(*outline(svg, "gap"), strict=True)
    assert (max(xs) - min(xs)) / (max(ys) - min(ys)) == pytest.approx(0.1 / 0.9, rel=0.02)
    assert outline(svg, "leaf")


def test_an_open_door_is_drawn_open():
    door = thing("door1", types=("Door",), size=(0.06, 0.9, 2), properties={"isOpen": True})
    assert outline(drawn(place("room", (2, 2), (4, 4)), door), "open")


def test_an_empty_map_and_a_huge_one_fit_the_sheet():
    for entities in ((), (place("field", (0, 0), (9000.0, 50.0)),), (place("tiny", (0, 0), (0.1, 0.1)),)):
        svg = drawn(*entities)
        wide, high = float(svg.get("width")[:-2]), float(svg.get("height")[:-2])
        for polygon in svg.iter(f"{SVG}polygon"):
            for pair in polygon.get("points").split():
                x, y = map(float, pair.split(","))
                assert 0.0 <= x <= wide
                assert 0.0 <= y <= high


def test_what_cannot_be_drawn_is_counted():
    nowhere = thing("ghost", size=None)
    assert "1 object without position or size" in texts(drawn(nowhere))


def test_a_pixel_and_its_point_of_the_map_find_one_another():
    drawn_ = draw(floor_of([place("room", (2, 2), (4, 4))]), title="", commit=1, stamp_ns=0)
    x, y = drawn_.pixel((1.5, 0.5))
    assert drawn_.point(x, y) == pytest.approx((1.5, 0.5))
    assert 0.0 < x < drawn_.wide_mm * 96 / 25.4
    assert 0.0 < y < drawn_.high_mm * 96 / 25.4
