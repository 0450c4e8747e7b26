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


def test_a_row_has_label_class_room_support_and_position():
    row = Table(ENTITIES, known()).rows(EntityFilter())["cup1"]
    assert row["label"] == "red cup"
    assert row["class"] == "Cup"
    assert (row["room"], row["on"]) == ("kitchen1", "table1")
    assert (row["x"], row["y"], row["z"]) == (1.0, 2.0, 0.75)


def test_entities_without_a_position_have_none_in_their_row():
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
def test_the_filter_selects_rows(wanted, found):
    assert shown(**wanted) == found


def test_the_body_column_has_the_model_and_marks_ghosts():
    bodies = {"cup1": body("cup1"), "ghost1": body("ghost1", model="", ghost=True)}
    rows = Table(ENTITIES, known(), bodies=bodies).rows(EntityFilter())
    assert rows["cup1"]["body"] == "cup"
    assert rows["ghost1"]["body"] == "box (ghost)"
    assert rows["table1"]["body"] == "no body"
    assert rows["kitchen1"]["body"] == "place"


def test_only_differences_between_rows_are_sent():
    before = Table(ENTITIES, known()).rows(EntityFilter())
    now = {**ENTITIES, "cup1": thing("cup1", preferred_reference="blue cup"), "new1": thing("new1")}
    del now["ghost1"]
    after = Table(now, known()).rows(EntityFilter())
    found = diff_rows(before, after)
    assert [row["name"] for row in found.add] == ["new1"]
    assert [row["name"] for row in found.update] == ["cup1"]
    assert found.remove == ["ghost1"]
    assert diff_rows(after, after) == ([], [], [])


def test_very_long_labels_are_cut():
    row = Table(by_name(thing("a", preferred_reference="x" * 1000)), known()).rows(EntityFilter())["a"]
    assert len(row["label"]) == 200


def test_markup_in_labels_stays_text():
    evil = "<script>alert(1)</script>"
    row = Table(by_name(thing("a", preferred_reference=evil)), known()).rows(EntityFilter(text="<SCRIPT>"))[
        "a"
    ]
    assert row["label"] == evil


def test_counts_are_formatted():
    assert format_count(80, 80) == "80 entities"
    assert format_count(1, 1) == "1 entity"
    assert format_count(12, 5000) == "12 of 5,000 entities"
    assert format_count(0, 0) == "the map is empty"


def test_the_filter_is_described_in_words():
    assert EntityFilter().words == ""
    assert EntityFilter(class_="Cup", room="kitchen1").words == "class Cup, in kitchen1"


def test_rows_can_be_created_for_some_entities():
    rows = Table(ENTITIES, known()).rows(EntityFilter(class_="Dishware"), {"cup1", "table1", "gone1"})
    assert list(rows) == ["cup1"]
