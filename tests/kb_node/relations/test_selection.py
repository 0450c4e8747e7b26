import pytest
from msgspec import structs

from semmap.nodes.kb_node.relations.facts.pair_facts import PairFacts
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.selection import resolve_single, resolve_word, select_entities
from semmap.schemas import errors
from semmap.schemas.relations import Where
from tests.kb_node.relations.entities import CORNER, ROOM, TABLE, TOP, thing

MAP = [
    ROOM,
    CORNER,
    TABLE,
    thing("tray1", (0.0, 0.0, TOP)),
    thing("cup1", (0.0, 0.0, TOP + 0.03), ref="my cup"),
    thing("cup2", (0.2, 0.4, TOP)),
    thing("bowl1", (0.0, -0.4, TOP)),
    thing("apple1", (0.0, -0.4, TOP + 0.02)),
    thing("lamp1", (2.0, 2.0, 0.0)),
    thing("lamp2", (9.0, 9.0, 0.0)),
]


def names(**where):
    return [e.name for e in select_entities(Space(MAP), MAP, Where(**where), MAP)]


def test_on_is_transitive():
    assert names(on="table1") == ["tray1", "cup1", "cup2", "bowl1", "apple1"]
    assert names(on="tray1") == ["cup1"]
    assert names(on="bowl1") == []


def test_in_is_a_place_or_a_container():
    assert names(in_="corner1") == ["lamp1"]
    assert "lamp1" in names(in_="kitchen1")
    assert "lamp2" not in names(in_="kitchen1")
    assert names(in_="bowl1") == ["apple1"]


@pytest.mark.parametrize(
    ("fact", "where", "found"),
    [
        (("cup1", "isOn", "tray1"), {"on": "tray1"}, []),
        (("cup1", "isOn", "tray1"), {"on": "table1"}, ["tray1", "cup2", "bowl1", "apple1"]),
        (("tray1", "isOn", "table1"), {"on": "table1"}, ["cup2", "bowl1", "apple1"]),
        (("cup2", "isOn", "tray1"), {"on": "tray1"}, ["cup1"]),
        (("apple1", "isInside", "bowl1"), {"in_": "bowl1"}, []),
        (("apple1", "isInside", "bowl1"), {"on": "table1"}, ["tray1", "cup1", "cup2", "bowl1"]),
        (("apple1", "isInside", "tray1"), {"in_": "bowl1"}, ["apple1"]),
        (("apple1", "isInside", "tray1"), {"on": "table1"}, ["tray1", "cup1", "cup2", "bowl1", "apple1"]),
        (("lamp1", "isLocatedIn", "corner1"), {"in_": "corner1"}, []),
        (("lamp1", "isLocatedIn", "kitchen1"), {"in_": "corner1"}, ["lamp1"]),
    ],
)
def test_suppressed_facts_do_not_count(fact, where, found):
    selected = select_entities(Space(MAP), MAP, Where(**where), MAP, {fact})
    assert [entity.name for entity in selected] == found


def test_in_is_a_container_at_any_depth():
    chest = thing("bowl7", (5.0, 5.0, 0.0), "bowl", size=(1.0, 1.0, 0.5))
    inner = thing("bowl8", (5.0, 5.0, 0.1))
    apple = thing("apple8", (5.0, 5.0, 0.12))
    there = [chest, inner, apple]
    for holder, found in (("bowl7", ["bowl8", "apple8"]), ("bowl8", ["apple8"])):
        selected = select_entities(Space(there), there, Where(in_=holder), there)
        assert [entity.name for entity in selected] == found


def test_what_can_hold_one_of_several_is_possible():
    """A word for several is rejected only if nothing can be on or in any of them."""
    there = [
        *(thing(f"relic{k}", (5.0 + k, 5.0, 0.0), ref="here") for k in range(2)),
        thing("k1", (0.0, 0.0, 0.0), place=True, ref="here"),
        thing("cup7", (0.0, 3.0, 0.5)),
        thing("bowl7", (0.0, 3.0, 0.0), ref="here"),
    ]

    def select(some, **where):
        return [e.name for e in select_entities(Space(some), some, Where(**where), some)]

    assert select(there, on="here") == select(there, in_="here") == []
    assert select(there, near="here", within=0.5) == ["cup7"]
    with pytest.raises(errors.Refused, match="the size of k1, relic0 and relic1 is unknown"):
        select(there[:3], on="here")
    with pytest.raises(errors.Refused, match="nothing can be in k1, relic0 and relic1"):
        select(there[:3], in_="here")
    assert select([*there, thing("ghost1", None, ref="here")], on="here") == []
    ghosts = [thing("ghost1", None, ref="gone"), thing("ghost2", None, ref="gone")]
    with pytest.raises(errors.Refused, match="ghost1 and ghost2 have no position"):
        select(ghosts, near="gone")
    with pytest.raises(errors.Refused, match="gone has no position"):
        select(ghosts, nearest=1, to="gone")


def test_near_within_and_nearest():
    assert names(near="cup1") == ["table1"]  # what it is on is not near it
    assert "tray1" in names(near="cup1", within=0.1)
    assert names(near="lamp1", within=0.5) == []
    assert names(nearest=2, to="cup2")[0] in ("table1", "tray1")
    assert len(names(nearest=2, to="cup2")) == 2
    assert names(nearest=9, to="lamp2", within=1.0) == []


def test_a_distance_is_inclusive():
    boxes = [
        thing("box1", (1.0, 0.0, 0.0), size=(1.0, 1.0, 1.0)),
        thing("box2", (4.0, 0.0, 0.0), size=(2.0, 1.0, 1.0)),
    ]

    def found(**where):
        return [e.name for e in select_entities(Space(boxes), boxes, Where(**where), boxes)]

    assert found(near="box1", within=1.5) == ["box2"]
    assert found(near="box1", within=1.49) == []
    assert found(nearest=3, to="box1", within=1.5) == ["box2"]
    assert found(nearest=3, to="box1", within=1.49) == []
    assert found(near="1,0,-0.4", within=0.4) == found(near="1,0,1.4", within=0.4) == ["box1"]
    assert found(near="1,0,-0.4", within=0.3) == found(near="1,0,1.4", within=0.3) == []
    assert found(nearest=3, to="0,0,0", within=0.5) == ["box1"]
    assert found(nearest=3, to="0,0,0", within=3.0) == ["box1", "box2"]
    assert found(nearest=1, to="0,0,0", within=3.0) == ["box1"]


def test_near_and_nearest_to_a_position():
    assert names(near="2,2,0", within=0.5) == ["lamp1"]
    assert names(near="-9,-9,0", within=0.5) == []
    assert names(nearest=1, to="9.5,9,0") == ["lamp2"]
    assert names(nearest=9, to="2,2,0", within=0.0001) == ["lamp1"]
    with pytest.raises(errors.BadRequest, match="--near 2,2,0 --within M"):
        names(near="2,2,0")
    with pytest.raises(errors.BadRequest, match="too far away"):
        names(near="20000,0,0", within=1.0)


def test_all_conditions_must_hold():
    assert names(on="table1", near="cup2", within=0.02) == []
    assert names(on="kitchen table", in_="kitchen") == names(on="table1")


def test_words():
    assert resolve_word(MAP, "my cup") == {"cup1"}
    assert resolve_word(MAP, "Cup") == {"cup1", "cup2"}
    with pytest.raises(errors.UnknownName, match="did you mean table1"):
        resolve_word(MAP, "tabel1")
    with pytest.raises(errors.UnknownName, match=r"'A cupp'; did you mean [Cc]up"):
        resolve_word(MAP, "A cupp")


@pytest.mark.parametrize(
    ("word", "names"),
    [
        ("CUP1", {"cup1"}),
        ("the cup", {"cup1", "cup2"}),
        ("tea_cup", {"cup3"}),
        ("Tea cup", {"cup3"}),
        ("a la carte", {"menu1"}),  # the article is part of the label
        ("the a la carte", {"menu1"}),
        ("la carte", {"menu2"}),
        ("bowl1", {"bowl1"}),  # also the label of another entity
    ],
)
def test_a_word_is_a_name_else_a_label_else_a_class(word, names):
    there = [
        *MAP,
        thing("cup3", None, ref="tea cup", model="mug"),
        thing("menu1", None, ref="a la carte"),
        thing("menu2", None, ref="carte"),
        thing("vase1", None, ref="bowl1"),
    ]
    assert resolve_word(there, word) == names


def test_an_exact_class_takes_precedence_over_a_label():
    called = thing("table7", (5.0, 5.0, 0.0), ref="table")
    assert resolve_word([*MAP, called], "Table") == {"table1", "table7"}
    assert resolve_word([*MAP, called], "table") == {"table7"}


def test_a_word_for_a_single_entity():
    assert resolve_single(MAP, "my cup") == "cup1"
    assert resolve_single(MAP, "kitchen") == "kitchen1"
    with pytest.raises(errors.BadRequest, match="'Cup' is ambiguous: cup1 and cup2; name one of them"):
        resolve_single(MAP, "Cup")
    with pytest.raises(errors.UnknownName):
        resolve_single(MAP, "missing")


@pytest.mark.parametrize("where", [{"within": 1.0}, {"nearest": 2}, {"to": "cup1"}])
def test_incomplete_conditions_are_rejected(where):
    with pytest.raises(errors.BadRequest, match="--"):
        names(**where)


@pytest.mark.parametrize(
    ("where", "reason"),
    [
        ({"on": "kitchen1"}, "kitchen1 is a place: objects are in a place, not on it"),
        ({"in_": "table1"}, "nothing can be in table1"),
    ],
)
def test_impossible_targets_are_rejected(where, reason):
    with pytest.raises(errors.Refused, match=reason):
        names(**where)


def test_a_table_contains_a_sink_that_is_let_into_it():
    sink = structs.replace(thing("sink1", (0.0, 0.0, TOP - 0.2), "", size=(0.4, 0.5, 0.2)), fixed=True)
    found = select_entities(Space([TABLE, sink]), [TABLE, sink], Where(in_="table1"), [TABLE, sink])
    assert [entity.name for entity in found] == ["sink1"]


def test_a_place_of_unknown_extent():
    nowhere = thing("k1", (0.0, 0.0, 0.0), place=True)
    with pytest.raises(errors.Refused, match="the extent of k1 is unknown"):
        select_entities(Space([*MAP, nowhere]), MAP, Where(in_="k1"), [*MAP, nowhere])


def test_near_agrees_with_the_fact():
    space = Space(MAP)
    pairs = PairFacts(Space(MAP))
    pairs.set_scope(("isNear",), ())
    for entity in MAP:
        if not entity.place:
            found = select_entities(space, MAP, Where(near=entity.name), MAP)
            assert [e.name for e in found] == [
                e.name for e in MAP if pairs.holds(e.name, "isNear", entity.name)
            ]


@pytest.mark.parametrize(
    ("where", "reason"),
    [
        ({"near": "kitchen1"}, r"kitchen1 is a place: near holds between objects only; use in \(--in\)"),
        ({"on": "ghost1"}, "ghost1 has no position, so what is on there is unknown"),
        ({"near": "ghost1"}, "ghost1 has no position, so what is near there is unknown"),
        ({"on": "relic1"}, "the size of relic1 is unknown, so what is on it is unknown"),
    ],
)
def test_unknown_locations_are_rejected(where, reason):
    everyone = [*MAP, thing("ghost1", None), thing("relic1", (1.0, 1.0, 0.0))]
    with pytest.raises(errors.Refused, match=reason):
        select_entities(Space(everyone), everyone, Where(**where), everyone)


def test_a_distance_from_a_place():
    assert names(near="corner1", within=0.1) == ["lamp1"]


def test_an_unknown_name_of_several_words_gets_a_suggestion():
    everyone = [ROOM, CORNER, thing("table1", (0.0, 0.0, 0.0), ref="table")]
    with pytest.raises(errors.UnknownName, match="did you mean table, kitchen or"):
        resolve_word(everyone, "kitchen table")
