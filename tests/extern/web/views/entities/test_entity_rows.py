import pytest

from semmap.nodes.extern.web.views.entities.entity_rows import EntityFilter, Table, diff_rows, format_count
from semmap.nodes.extern.web.views.entities.locations import Locations
from semmap.schemas.entities import Pose
from semmap.schemas.scenes import Body
from tests.extern.web.views.sample_maps import by_name, fact, place, thing

ENTITIES = by_name(
    place("kitchen1"),
    thing("cup1", types=("Dishware",), at=(1.0, 2.0004, 0.75), preferred_reference="red cup"),
    thing("table1", "Table", types=("Furniture",), alternative_references=("desk of Anna",)),
    thing("ghost1", "Beer", at=None),
)


def known():
    locations = Locations()
    locations.reset(
        [
            fact("cup1", "isOn", "table1"),
            fact("cup1", "isLocatedIn", "kitchen1"),
            fact("table1", "isLocatedIn", "kitchen1"),
        ]
    )
    return locations


def body(name, *, model="cup", ghost=False):
    return Body(
        name=name, class_=None, model=model, pose=Pose(position_m=(0.0, 0.0, 0.0)), size_m=(1.0, 1.0, 1.0),
        fixed=False, entity=True, ghost=ghost, resting=True, commit=1, shape_commit=1
    )  # fmt: skip


def shown(**wanted):
    return set(Table(ENTITIES, known()).rows(EntityFilter(**wanted)))


def test_a_row_says_what_it_is_called_where_it_is_and_what_it_is_on():
    row = Table(ENTITIES, known()).rows(EntityFilter())["cup1"]
    assert row["label"] == "red cup"
    assert row["class"] == "Cup"
    assert (row["room"], row["on"]) == ("kitchen1", "table1")
    assert (row["x"], row["y"], row["z"]) == (1.0, 2.0, 0.75)


def test_what_has_no_position_has_none_in_its_row():
    assert Table(ENTITIES, known()).rows(EntityFilter())["ghost1"]["x"] is None


@pytest.mark.parametrize(
    ("wanted", "found"),
    [
        ({}, set(ENTITIES)),
        ({"text": "RED"}, {"cup1"}),
        ({"text": "anna desk"}, {"table1"}),
        ({"text": "cup anna"}, set()),
        ({"class_": "Dishware"}, {"cup1"}),
        ({"class_": "Cup"}, {"cup1"}),
        ({"room": "kitchen1"}, {"cup1", "table1"}),
        ({"support": "table1"}, {"cup1"}),
        ({"things": frozenset({"ghost1", "gone1"})}, {"ghost1"}),
        ({"room": "kitchen1", "class_": "Furniture"}, {"table1"}),
    ],
)
def test_what_is_wanted_is_shown(wanted, found):
    assert shown(**wanted) == found


def test_the_body_is_told_by_its_model_and_ghosts_as_such():
    bodies = {"cup1": body("cup1"), "ghost1": body("ghost1", model="", ghost=True)}
    rows = Table(ENTITIES, known(), bodies=bodies).rows(EntityFilter())
    assert rows["cup1"]["body"] == "cup"
    assert rows["ghost1"]["body"] == "box (ghost)"
    assert rows["table1"]["body"] == "no body"
    assert rows["kitchen1"]["body"] == "place"


def test_only_what_is_otherwise_is_told():
    before = Table(ENTITIES, known()).rows(EntityFilter())
    now = {**ENTITIES, "cup1": thing("cup1", preferred_reference="blue cup"), "new1": thing("new1")}
    del now["ghost1"]
    after = Table(now, known()).rows(EntityFilter())
    found = diff_rows(before, after)
    assert [row["name"] for row in found.add] == ["new1"]
    assert [row["name"] for row in found.update] == ["cup1"]
    assert found.remove == ["ghost1"]
    assert diff_rows(after, after) == ([], [], [])


def test_very_long_references_are_cut_in_the_table():
    row = Table(by_name(thing("a", preferred_reference="x" * 1000)), known()).rows(EntityFilter())["a"]
    assert len(row["label"]) == 200


def test_markup_is_text_like_any_other():
    evil = "<script>alert(1)</script>"
    row = Table(by_name(thing("a", preferred_reference=evil)), known()).rows(EntityFilter(text="<SCRIPT>"))[
        "a"
    ]
    assert row["label"] == evil


def test_counts_are_told():
    assert format_count(80, 80) == "80 entities"
    assert format_count(1, 1) == "1 entity"
    assert format_count(12, 5000) == "12 of 5,000 entities"
    assert format_count(0, 0) == "the map is empty"


def test_the_conditions_are_told():
    assert EntityFilter().words == ""
    assert EntityFilter(class_="Cup", room="kitchen1").words == "class Cup, in kitchen1"


def test_some_rows_are_made_without_the_others():
    rows = Table(ENTITIES, known()).rows(EntityFilter(class_="Dishware"), {"cup1", "table1", "gone1"})
    assert list(rows) == ["cup1"]
