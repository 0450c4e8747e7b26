"""Situations in which an object leans against another one, or does not."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec import structs

from benchmarks.relations.situations import about_y
from semmap.nodes.kb_node.relations.facts.pair_facts import PairFacts
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.relations.relation_reports import explain_relation, list_relations
from semmap.ontology.model_shapes import shapes
from semmap.schemas.commands import Relations
from semmap.schemas.entities import Pose
from tests.depth import tries
from tests.kb_node.relations.entities import ROOM, TABLE, TOP, thing

WALL = thing("wall1", (-0.05, 0.0, 0.0), "", size=(0.1, 3.0, 2.5))
"""Its face is the plane x = 0."""
PLANK, BROOM, PICTURE, LADDER = (0.02, 0.2, 1.5), (0.07, 0.32, 1.35), (0.03, 0.6, 0.45), (0.08, 0.4, 2.0)


def times(one, other):
    """Return the product of two quaternions."""
    (a, b, c, d), (e, f, g, h) = one, other
    return (
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    )


def about_z(degrees):
    return (math.cos(math.radians(degrees) / 2), 0.0, 0.0, math.sin(math.radians(degrees) / 2))


def moved(entity, by=(0.0, 0.0, 0.0), yaw_deg=0.0):
    """Return an entity after a rotation about the origin and a translation."""
    (x, y, z), turn = entity.pose.position_m, math.radians(yaw_deg)
    at = (
        x * math.cos(turn) - y * math.sin(turn) + by[0],
        x * math.sin(turn) + y * math.cos(turn) + by[1],
        z + by[2],
    )
    wxyz = times(about_z(yaw_deg), entity.pose.orientation_wxyz)
    return structs.replace(entity, pose=Pose(position_m=at, orientation_wxyz=wxyz))


def tilted(name, size, degrees, *, gap=0.0, floor=0.0, model=""):
    """Return an upright thing that is tilted towards the wall, at a distance from it."""
    (width, _, height), angle = size, math.radians(degrees)
    foot = height * math.sin(angle) + gap
    at = (foot + width / 2 * math.cos(angle), 0.0, floor + width / 2 * math.sin(angle))
    return thing(name, at, model, size=size, turn=about_y(-degrees))


def box(name, x, size, *, y=0.0, z=0.0, yaw=0.0):
    """Return an upright box whose nearest side is at a distance `x` from the wall."""
    return thing(name, (x + size[0] / 2, y, z), "", size=size, yaw=yaw)


BOOK = (0.03, 0.16, 0.24)
CARD = (0.004, 0.2, 0.3)
SHELF = thing("shelf1", (0.0, 0.0, 0.0), "bookshelf")
BOARD = min(surface.height for surface in shapes()["bookshelf"].surfaces)
SLOPE = 0.3 * math.sin(math.radians(20.0)) / 2
"""Half the distance of the feet of two cards at 20 degrees."""

LEANING = {
    "a broom": ((WALL, tilted("a1", BROOM, 12.0, model="broom")), "wall1"),
    "a plank a little tilted": ((WALL, tilted("a1", PLANK, 5.5)), "wall1"),
    "a plank at thirty degrees": ((WALL, tilted("a1", PLANK, 30.0)), "wall1"),
    "a plank at sixty degrees": ((WALL, tilted("a1", PLANK, 60.0)), "wall1"),
    "a ladder": ((WALL, tilted("a1", LADDER, 18.0)), "wall1"),
    "a picture on the floor": ((WALL, tilted("a1", PICTURE, 10.0, model="picture")), "wall1"),
    "in a room": ((ROOM, WALL, tilted("a1", BROOM, 12.0)), "wall1"),
    "in a room whose floor is lower": (
        (
            thing("cellar1", (0.0, 0.0, -1.0), size=(6.0, 6.0, 3.0), place=True),
            WALL,
            tilted("a1", BROOM, 12.0, floor=-1.0),
        ),
        "wall1",
    ),
    "a picture on a shelf board": (
        (WALL, box("shelf1", 0.0, (0.3, 0.8, 0.04), z=1.0), tilted("a1", PICTURE, 10.0, floor=1.04)),
        "wall1",
    ),
    "within the tolerance of a pose": ((WALL, tilted("a1", PLANK, 20.0, gap=0.045)), "wall1"),
    "sunk into the wall": ((WALL, tilted("a1", PLANK, 20.0, gap=-0.03)), "wall1"),
    "sunk into the floor": ((WALL, tilted("a1", PLANK, 20.0, floor=-0.03)), "wall1"),
    "a thick block": ((WALL, tilted("a1", (0.4, 0.4, 1.0), 12.0)), "wall1"),
    "a can": ((WALL, tilted("a1", (0.067, 0.067, 0.121), 25.0, model="can")), "wall1"),
    "a book on a table against a box": (
        (
            TABLE,
            moved(tilted("a1", BOOK, 20.0), (0.0, 0.0, TOP)),
            thing("b1", (-0.1, 0.0, TOP), "", size=(0.2, 0.2, 0.3)),
        ),
        "b1",
    ),
    "against the edge of a lower box": (
        (box("b1", -0.3, (0.3, 0.5, 1.0)), moved(tilted("a1", PLANK, 25.0), (-0.168, 0.0, 0.0))),
        "b1",
    ),
    "a book against the first of two": (
        (box("c1", -0.06, BOOK), box("b1", -0.03, BOOK), tilted("a1", BOOK, 20.0)),
        "b1",
    ),
    "one of two cards": (
        (
            thing("a1", (2 * SLOPE, 0.0, 0.0), "", size=CARD, turn=about_y(-20.0)),
            thing("b1", (-2 * SLOPE, 0.0, 0.0), "", size=CARD, turn=about_y(20.0)),
        ),
        "b1",
    ),
    "upright on the edge of a table, most of it beyond the edge": (
        (
            box("b1", 0.17, (0.5, 0.5, 0.7)),
            box("a1", 0.0, (0.3, 0.3, 0.6), z=0.7),
            thing("wall1", (-0.05, 0.0, 0.0), "", size=(0.1, 3.0, 2.5)),
        ),
        "wall1",
    ),
    "on the floor of a cupboard": (
        (
            SHELF,
            thing(
                "b1",
                (0.0, 0.0, BOARD),
                "",
                size=(0.2, 0.05, 0.2),
            ),
            moved(
                tilted("a1", (0.02, 0.15, 0.2), 15.0),
                (0.0, 0.025, BOARD),
                90.0,
            ),
        ),
        "b1",
    ),
}

STANDS = "it needs no support at its side"
NOT_LEANING = {
    "a box flush with a wall": ((WALL, box("a1", 0.0, (0.4, 0.4, 1.0))), "wall1", STANDS),
    "a box flush with a box": (
        (box("wall1", -0.4, (0.4, 0.4, 1.0)), box("a1", 0.0, (0.4, 0.4, 1.0))),
        "wall1",
        STANDS,
    ),
    "a thin plank that stands upright": ((WALL, box("a1", 0.0, PLANK)), "wall1", STANDS),
    "a plank that is hardly tilted": ((WALL, tilted("a1", PLANK, 3.0)), "wall1", "by less than 5°"),
    "a chair at a table": (
        (TABLE, thing("a1", (0.55, 0.0, 0.0), "chair", yaw=math.pi)),
        "table1",
        STANDS,
    ),
    "a table at a wall": (
        (WALL, thing("a1", (0.4, 0.0, 0.0), "table")),
        "wall1",
        STANDS,
    ),
    "a picture on a wall": (
        (WALL, thing("a1", (0.015, 0.0, 1.4), "picture")),
        "wall1",
        "nothing but wall1 may support it",
    ),
    "a picture that hangs tilted": (
        (WALL, tilted("a1", PICTURE, 10.0, floor=1.4)),
        "wall1",
        "nothing but wall1 may support it",
    ),
    "a ball at a wall": ((WALL, thing("a1", (0.1, 0.0, 0.0), "ball")), "wall1", ""),
    "a bottle that lies along a wall": (
        (WALL, thing("a1", (0.0404, -0.14, 0.0404), "bottle", turn=times(about_z(90.0), about_y(90.0)))),
        "wall1",
        STANDS,
    ),
    "away from the wall": ((WALL, tilted("a1", PLANK, 20.0, gap=0.2)), "wall1", "they are 20.0 cm apart"),
    "tilted away from the wall": (
        (
            WALL,
            thing("a1", (0.02, 0.0, 0.0), "", size=PLANK, turn=about_y(20.0)),
        ),
        "wall1",
        "below its centre",
    ),
    "a low step at the foot": (
        (box("b1", 0.0, (0.1, 0.5, 0.1)), moved(tilted("a1", PLANK, 10.0), (-0.15, 0.0, 0.0))),
        "b1",
        "below its centre",
    ),
    "a flat slope over an edge": (
        (box("b1", -0.3, (0.3, 0.5, 0.4)), moved(tilted("a1", PLANK, 55.0), (-0.65, 0.0, 0.0))),
        "b1",
        "from above or below",
    ),
    "a wall along its side": (
        (WALL, thing("b1", (0.5, 0.15, 0.0), "", size=(3.0, 0.1, 2.5)), tilted("a1", PLANK, 20.0)),
        "b1",
        "by less than 5°",
    ),
    "the wall itself": ((WALL, tilted("b1", PLANK, 20.0), tilted("a1", PLANK, 20.0)), "a1", ""),
    "behind the first of two": (
        (box("c1", -0.06, BOOK), box("b1", -0.03, BOOK), tilted("a1", BOOK, 20.0)),
        "c1",
        "b1 is between them",
    ),
    "a place": ((ROOM, tilted("a1", PLANK, 20.0)), "kitchen1", "kitchen1 is a place"),
    "of unknown size": (
        (WALL, thing("a1", (0.0, 0.0, 0.0), "unheard of")), "wall1", "the size of a1 is unknown",
    ),
    "on a box, tilted over its edge": (
        (
            TABLE,
            thing("b1", (0.2, 0.0, TOP), "", size=(0.1, 0.3, 0.05)),
            thing(
                "a1", (0.2 * math.cos(0.32), 0.0, TOP + 0.2 * math.sin(0.32)), "", size=(0.4, 0.3, 0.01),
                turn=about_y(-math.degrees(0.32)),
            ),
        ),
        "b1",
        "it is on b1",
    ),
}  # fmt: skip


def explained(things, other, name="a1"):
    return explain_relation(Space(things), name, "isLeaningAgainst", other)


@pytest.mark.parametrize("title", LEANING)
def test_what_leans(title):
    things, other = LEANING[title]
    found = explained(things, other)
    assert found.holds, found.text
    assert "so it would not stand alone" in found.text


@pytest.mark.parametrize("title", NOT_LEANING)
def test_what_does_not_lean(title):
    things, other, reason = NOT_LEANING[title]
    found = explained(things, other)
    assert not found.holds, found.text
    assert reason in found.text


def list_leaning(things):
    """Return all facts by both ways of measuring them, which must agree."""
    space = Space(things)
    listed = {
        (r.subject, r.object)
        for each in things
        for r in list_relations(space, Relations(name=each.name))
        if r.relation == "isLeaningAgainst" and r.holds
    }
    facts = PairFacts(Space(things))
    found = {(a, b) for a, r, b in facts.set_scope(("isLeaningAgainst",), ()).come}
    assert found == listed
    return found


EVERY = {title: row[0] for title, row in {**LEANING, **NOT_LEANING}.items()}


@settings(max_examples=tries(90), deadline=None)
@given(
    title=st.sampled_from(sorted(EVERY)),
    yaw_deg=st.floats(-180.0, 180.0),
    x=st.floats(-50.0, 50.0),
    y=st.floats(-50.0, 50.0),
)
def test_moving_or_turning_everything_changes_nothing(title, yaw_deg, x, y):
    things = [each for each in EVERY[title] if not each.place]
    before = list_leaning(things)
    after = list_leaning([moved(each, (x, y, 0.0), yaw_deg) for each in things])
    assert after == before
    assert all(one != other for one, other in after)


@settings(max_examples=tries(60), deadline=None)
@given(degrees=st.floats(0.0, 60.0), width=st.floats(0.005, 0.3), height=st.floats(0.3, 2.0))
def test_the_least_tilt_separates_what_leans(degrees, width, height):
    found = explained((WALL, tilted("a1", (width, 0.2, height), degrees)), "wall1").holds
    if degrees < 4.9:
        assert not found
    angle = math.radians(degrees)
    beside = abs(height * math.sin(angle) - width * math.cos(angle)) / 2  # 2 mm count as balanced
    if degrees > 5.1 and width < 0.2 * height and beside > 0.003:
        assert found


@pytest.mark.parametrize(("gap", "leans"), [(0.049, True), (0.051, False)])
def test_the_greatest_gap_separates_what_leans(gap, leans):
    assert explained((WALL, tilted("a1", PLANK, 20.0, gap=gap)), "wall1").holds == leans


def test_the_thresholds_are_those_of_the_tbox():
    things = (WALL, tilted("a1", PLANK, 20.0, gap=0.04))
    for limits in (Thresholds(lean_gap_m=0.03), Thresholds(lean_deg=25.0)):
        assert not explain_relation(Space(things, limits), "a1", "isLeaningAgainst", "wall1").holds


def test_both_walls_of_a_corner_and_both_cards():
    corner = thing("wall2", (0.0, -0.05, 0.0), "", size=(3.0, 0.1, 2.5))
    broom = moved(tilted("a1", (0.03, 0.03, 1.3), 15.0), yaw_deg=45.0)
    assert list_leaning([WALL, corner, moved(broom, (0.012, 0.012, 0.0))]) == {
        ("a1", "wall1"),
        ("a1", "wall2"),
    }
    assert list_leaning(LEANING["one of two cards"][0]) == {("a1", "b1"), ("b1", "a1")}


def test_the_explanation_has_the_numbers():
    found = explained((WALL, tilted("a1", PLANK, 10.0)), "wall1")
    assert found.text == (
        "a1 is leaning against wall1: it leans over by 10.0° from its base to wall1, which it"
        " meets at a height of 1.48 m; its centre, at 74.0 cm, is 12.0 cm beside its base,"
        " so it would not stand alone"
    )
    back = explained((WALL, tilted("a1", PLANK, 10.0)), "a1", "wall1")
    assert back.text == f"wall1 is not leaning against a1: {STANDS}: its centre is above its base"


def test_the_wall_reports_what_leans_against_it():
    space = Space([WALL, tilted("a1", PLANK, 10.0)])
    found = [(r.subject, r.relation, r.object) for r in list_relations(space, Relations(name="wall1"))]
    assert ("a1", "isLeaningAgainst", "wall1") in found


def test_facts_follow_what_moves():
    plank, book = tilted("a1", BOOK, 20.0), box("b1", -0.03, BOOK)
    far = moved(book, (0.0, 2.0, 0.0))
    facts = PairFacts(Space([far, plank, box("c1", -0.06, BOOK)]))
    facts.set_scope(("isLeaningAgainst",), ())
    assert facts.holds("a1", "isLeaningAgainst", "c1")
    changed = facts.update([book])
    assert changed.gone == {("a1", "isLeaningAgainst", "c1")}
    assert changed.come == {("a1", "isLeaningAgainst", "b1")}
    assert not facts.holds("b1", "isLeaningAgainst", "a1")
    assert facts.update([far]).come == {("a1", "isLeaningAgainst", "c1")}
    assert facts.update((), ["c1"]).gone == {("a1", "isLeaningAgainst", "c1")}
