"""The updates of the map from a track."""

import math
from dataclasses import replace

import pytest
from msgspec import structs

from semmap.nodes.perception_node.tracking.class_hierarchy import ANYTHING
from semmap.nodes.perception_node.tracking.fits import KnownFit
from semmap.nodes.perception_node.tracking.map_updates import (
    AGENT,
    additions,
    has_moved,
    is_own,
    is_sure,
    removal_of_leg,
    subject_of,
    update_of,
    with_load,
)
from semmap.nodes.perception_node.tracking.tracks import Track
from semmap.nodes.perception_node.tracking.votes import Votes
from semmap.schemas.commands import Add, Remove, Undo, Update
from semmap.schemas.entities import Provenance, orientation_from_yaw
from semmap.schemas.perception import DISPLACED, MISSING
from tests.perception_node.things import CLASSES, CONFIG, SIZES, at, entity, seen

MARK = replace(CONFIG, when_gone="mark")


def track(class_="Cup", pose=None, size_m=None, *, p=0.95, **more):
    votes = Votes()
    for _ in range(6):
        votes = votes.cast(class_, p, 1.0)
    known = {"frames": 10, "whole_frames": 10, "whole": True, "sized": 1.0, "sighted": more.get("frames", 10)}
    return Track(pose or at(1, 1), size_m or SIZES.get(class_, SIZES["Cup"]), votes, **known | more)


def cup(**more):
    own = {"source": "perception", "confidence": 0.9} | more
    return entity("cup1", own.pop("class_", "Cup"), own.pop("pose", at(1, 1)), own.pop("size_m", None), **own)


def told(track_, entity_=None, config=CONFIG):
    return update_of(entity_ or cup(), track_, CLASSES, config)


def test_a_command_is_about_an_entity_or_a_new_one_of_a_class():
    (add,) = additions([track()], set(), CLASSES).values()
    assert subject_of(add) == "a new Cup"
    assert subject_of(Remove(names=("cup1", "cup2"))) == "cup1 cup2"
    assert subject_of(Update(name="cup1")) == "cup1"
    with pytest.raises(TypeError, match="Undo"):
        subject_of(Undo())


@pytest.mark.parametrize(
    ("frames", "p", "whole", "unseen", "sure"),
    [
        (2, 0.95, True, 0, True),
        (1, 0.95, True, 0, False),
        (2, 0.6, True, 0, False),
        (3, 0.6, True, 0, True),
        (3, 0.95, True, 1, False),
        (3, 0.95, False, 0, False),
        (4, 0.95, False, 0, True),
        (4, 0.95, False, 1, False),
    ],
)
def test_a_thing_is_sure_after_enough_looks_and_sooner_if_it_is_clear(frames, p, whole, unseen, sure):
    config = replace(CONFIG, clear_frames=2, confirm_frames=3, part_frames=4, clear=0.8)
    assert is_sure(track(frames=frames, p=p, whole=whole, unseen=unseen), CLASSES, config) is sure


@pytest.mark.parametrize(
    ("class_", "whole", "label", "sure"),
    [
        ("Object", True, "", True),
        ("Object", False, "", False),
        ("Object", False, "drill", True),
        ("Cup", False, "", True),
    ],
)
def test_a_thing_of_no_class_must_be_seen_completely(class_, whole, label, sure):
    seen = track(class_, frames=9, whole=whole, label=label)
    assert is_sure(seen, CLASSES, CONFIG) is sure


def test_new_entities_have_free_names_and_say_what_was_seen():
    found = additions(
        [
            track(pose=at(1.23456, 2, 0.70004, yaw=0.5), size_m=(0.0812, 0.08, 0.0001)),
            track("Bottle"),
            track(),
        ],
        {"cup1"},
        CLASSES,
    )
    assert list(found) == ["cup2", "bottle1", "cup3"]
    add = found["cup2"]
    assert isinstance(add, Add)
    assert (add.source, add.agent, add.reason) == ("perception", AGENT, "cup2 was seen")
    assert (add.class_, add.name, add.ref) == ("Cup", "cup2", "cup")
    assert add.at == pytest.approx((1.235, 2.0, 0.7), abs=1e-3)
    assert add.size == (0.081, 0.08, 0.001)
    assert 0.8 < add.confidence <= 1.0
    assert add.confidence == round(add.confidence, 3)


def test_what_is_as_the_map_says_is_no_news():
    assert told(track()) is None
    assert told(track(), cup(source="operator", confidence=None)) is None


@pytest.mark.parametrize(
    ("changes", "is_told"),
    [
        ({"left": True}, True),
        ({"left": True, "frames": 0}, False),
        ({"left": True, "frames": 1}, False),
        ({"left": True, "frames": 1, "occupied": 1}, True),
        ({"left": True, "unseen": 1}, False),
        ({"left": True, "odd": 1}, False),
        ({"whole_frames": 4}, False),
        ({"whole_frames": 5}, True),
        ({"whole_frames": 5, "kept": True}, False),
        ({"whole_frames": 40, "kept": True}, True),
        ({"whole_frames": 2, "part": True}, True),
        ({"whole_frames": 2, "part": True, "whole": False}, False),
        ({"whole_frames": 2, "outsized": True}, True),
    ],
    ids=str,
)
def test_a_move_is_told_once_it_is_sure(changes, is_told):
    update = told(track(pose=at(2, 1), **changes))
    assert (update is not None) is is_told
    if is_told:
        assert isinstance(update, Update)
        assert update.at == (2.0, 1.0, 0.7)
        assert update.reason == "cup1 has moved"


@pytest.mark.parametrize(("x", "moved"), [(1.029, False), (1.031, True)])
def test_a_thing_has_moved_when_it_is_off_by_more_than_a_little(x, moved):
    assert has_moved(cup(), track(pose=at(x, 1)), CONFIG) is moved
    assert has_moved(cup(pose=None), track(), CONFIG)


@pytest.mark.parametrize(("x", "moved"), [(1.09, False), (1.11, True)])
def test_a_big_thing_may_be_off_by_more(x, moved):
    assert has_moved(cup(), track(pose=at(x, 1), size_m=(2.0, 1.0, 1.0)), CONFIG) is moved


@pytest.mark.parametrize(("turn_deg", "moved"), [(19.0, False), (21.0, True), (-21.0, True), (179.0, False)])
def test_what_is_long_has_moved_when_it_is_turned(turn_deg, moved):
    book = entity("book1", "Book", at(1, 1))
    turned = track("Book", at(1, 1, yaw=math.radians(turn_deg)), (0.16, 0.24, 0.03))
    assert has_moved(book, turned, CONFIG) is moved


def test_a_model_that_is_turned_otherwise_is_told_after_some_looks():
    fit = KnownFit("Cup", 0.9, orientation_from_yaw(1.0), 1)
    update = told(track(fit=fit))
    assert update.orientation == pytest.approx(orientation_from_yaw(1.0), abs=1e-6)
    assert told(track(fit=fit, frames=4)) is None
    assert told(track(fit=fit), cup(source="operator", confidence=None)) is None
    assert told(track(fit=replace(fit, orientation_wxyz=orientation_from_yaw(0.05)))) is None


def test_when_only_the_front_was_known_the_rest_is_told_at_once():
    front = entity("shelf1", "Object", at(1.19, 1, 0.0), (0.02, 1.0, 1.8), source="perception")
    whole = track("Object", at(1.0, 1, 0.0), (0.4, 1.0, 1.8), frames=2, whole_frames=2)
    update = told(whole, front)
    assert (update.at, update.size) == ((1.0, 1.0, 0.0), (0.4, 1.0, 1.8))


def test_what_is_gone_is_removed_if_it_is_perception_s_own():
    empty = told(track(unseen=4))
    assert (empty.names, empty.source, empty.agent) == (("cup1",), "perception", AGENT)
    assert empty.reason == "cup1 is gone: its place was empty in 4 consecutive frames"
    odd = told(track(odd=6))
    assert odd.reason == "cup1 is gone: something else was in its place in 6 consecutive frames"
    assert told(track(unseen=3)) is None


@pytest.mark.parametrize(("changes", "conflict"), [({"unseen": 4}, MISSING), ({"odd": 6}, DISPLACED)])
def test_what_an_operator_said_is_marked_once_and_so_is_all_if_that_is_wished(changes, conflict):
    operators = cup(source="operator", confidence=None)
    for config, what in ((CONFIG, operators), (MARK, cup())):
        update = told(track(**changes), what, config)
        assert isinstance(update, Update)
        assert (update.name, update.conflict, update.reason) == ("cup1", conflict, f"cup1: {conflict}")
        assert told(track(**changes), structs.replace(what, conflict=conflict), config) is None


def test_it_is_perception_s_own_only_if_nobody_has_named_or_measured_it():
    assert is_own(cup())
    said = Provenance(commit=1, stamp_ns=1, source="operator")
    assert not is_own(structs.replace(cup(), reference_provenance=said))
    assert not is_own(structs.replace(cup(), shape_provenance=said))


def test_a_more_special_class_is_told_with_what_it_is_called():
    vague = cup(class_="Tableware", size_m=SIZES["Cup"], preferred_reference="tableware")
    update = told(track(), vague)
    assert (update.class_, update.reason) == ("Cup", "better view of cup1")
    assert update.confidence > 0.8
    assert told(track(frames=2, whole_frames=2), vague) is None
    named = told(track(), structs.replace(vague, preferred_reference="my mug"))
    assert named.class_ == "Cup"
    assert not named.ref


def test_another_class_is_told_only_where_looks_are_sure_of_it():
    book = cup(class_="Book", size_m=SIZES["Cup"])
    assert told(track(p=0.95), book).class_ == "Cup"
    assert told(track(p=0.5), book) is None


def test_what_is_like_nothing_known_loses_its_class():
    update = told(track(ANYTHING, size_m=SIZES["Cup"]))
    assert update.class_ == ANYTHING


def test_against_an_operator_s_class_a_conflict_is_noted_until_it_is_borne_out():
    operators = cup(class_="Book", size_m=SIZES["Cup"], source="operator", confidence=None)
    update = told(track(), operators)
    assert update.conflict == "looks like a Cup"
    assert not update.class_
    noted = structs.replace(operators, conflict="looks like a Cup")
    assert told(track(), noted) is None
    assert told(track("Book", size_m=SIZES["Cup"]), noted).conflict == ""
    back = structs.replace(operators, class_="Cup", conflict=MISSING)
    assert told(track(), back).conflict == ""


@pytest.mark.parametrize(
    ("size_m", "changes", "resized"),
    [
        ((0.08, 0.08, 0.13), {}, True),
        ((0.08, 0.08, 0.12), {}, False),
        ((0.08, 0.08, 0.13), {"frames": 4}, False),
        ((0.08, 0.08, 0.13), {"frames": 4, "part": True}, True),
        ((0.08, 0.08, 0.13), {"frames": 4, "outsized": True}, True),
        ((0.08, 0.08, 0.13), {"whole": False}, False),
        ((0.095, 0.08, 0.1), {}, False),
        ((0.11, 0.08, 0.1), {}, True),
    ],
    ids=str,
)
def test_another_size_is_told_where_the_whole_was_seen_often_enough(size_m, changes, resized):
    update = told(track(size_m=size_m, **changes))
    assert (update is not None and update.size is not None) is resized
    if resized:
        assert update.size == size_m
        assert told(track(size_m=size_m, **changes), cup(source="operator", confidence=None)) is None


def test_a_size_that_the_map_lacks_is_told_after_some_looks_too():
    unsized = structs.replace(cup(), size_m=None)
    assert told(track(frames=4), unsized) is None
    assert told(track(), unsized).size == SIZES["Cup"]


def test_a_thin_extent_may_be_off_by_centimetres():
    book = entity("book1", "Book", at(1, 1), (0.16, 0.24, 0.01), source="perception")
    assert told(track("Book", size_m=(0.16, 0.24, 0.024)), book) is None
    assert told(track("Book", size_m=(0.16, 0.24, 0.027)), book).size == (0.16, 0.24, 0.027)


def test_a_move_takes_along_what_is_not_seen_and_leaves_what_is():
    table = entity("table1", "Object", at(1, 1, 0.0), (0.8, 0.6, 0.7))
    on_it = entity("cup1", "Cup", at(1.2, 1.2, 0.7))
    near, far = entity("cup2", "Cup", at(2.4, 1, 0.0)), entity("cup3", "Cup", at(2.6, 1, 0.0))
    below, gone = entity("cup4", "Cup", at(1, 1, -0.6)), entity("cup5", "Cup", None)
    move = Update(name="table1", at=(3.0, 1.0, 0.0))
    carried = with_load(move, table, [table, on_it, near, far, below, gone])
    assert carried.carry
    assert carried.leave == ("cup1", "cup2")
    unknown = with_load(move, structs.replace(table, size_m=None), [far])
    assert unknown.leave == ("cup3",)


def test_what_is_no_move_takes_nothing_along():
    table = entity("table1", "Object", at(1, 1, 0.0), (0.8, 0.6, 0.7))
    for command in (None, Remove(names=("table1",)), Update(name="table1", conflict=MISSING)):
        assert with_load(command, table, []) is command
    nowhere = structs.replace(table, pose=None)
    move = Update(name="table1", at=(3.0, 1.0, 0.0))
    assert with_load(move, nowhere, []) is move


def test_a_leg_is_removed_with_the_reason():
    leg = removal_of_leg("leg1", "table1")
    assert (leg.names, leg.reason, leg.source) == (("leg1",), "leg1 is a leg of table1", "perception")


def test_the_label_of_a_detector_is_kept_in_its_own_words():
    (add,) = additions([track("Object", label="power drill")], set(), CLASSES).values()
    assert (add.class_, add.ref) == ("Object", "power drill")
    named = told(track(label="my mug"), cup(preferred_reference=CLASSES.label("Cup")))
    assert isinstance(named, Update)
    assert named.ref == "my mug"
    assert told(track(label="other mug"), cup(preferred_reference="my mug")) is None


def with_labels(*labels):
    """Return a track after observations with these labels; None for one without a detector's label."""
    found = track()
    for label in labels:
        observed = structs.replace(seen("Cup", at(1, 1)), label=label or "", labelled=label is not None)
        found = found.see(observed, CONFIG)
    return found


@pytest.mark.parametrize(
    ("labels", "expected"),
    [
        pytest.param(["mug"], "mug", id="first"),
        pytest.param(["mug"] * 20 + [None] * 50, "mug", id="no detector"),
        pytest.param(["mug"] * 20 + ["tumbler"], "mug", id="one other"),
        pytest.param(["mug"] * 20 + ["tumbler"] * 15, "tumbler", id="replaced"),
        pytest.param(["mug"] * 20 + [""] * 15, "", id="a class instead"),
        pytest.param(["mug"] * 20 + ["tumbler", "mug"] * 20, "mug", id="alternating"),
    ],
)
def test_a_label_is_replaced_by_a_clear_majority_of_recent_labels(labels, expected):
    assert with_labels(*labels).label == expected


def test_an_observation_of_another_program_counts_with_its_label_alone():
    assert track().see(structs.replace(seen("Cup", at(1, 1)), label="mug"), CONFIG).label == "mug"


@pytest.mark.parametrize(("later", "reference"), [("tumbler", "tumbler"), ("", CLASSES.label("Cup"))])
def test_the_map_follows_the_label_of_a_track(later, reference):
    mug = cup(preferred_reference="mug")
    assert told(with_labels(*["mug"] * 20, later), mug) is None
    changed = told(with_labels(*["mug"] * 20, *[later] * 15), mug)
    assert isinstance(changed, Update)
    assert changed.ref == reference
    assert changed.class_ is None


def voted(**shares):
    """Return a track whose classes have these shares of its votes."""
    return replace(track(), votes=Votes(shares, 1.0))


@pytest.mark.parametrize(
    ("shares", "class_"),
    [
        ({"Cup": 0.61, "Book": 0.24}, "Cup"),
        ({"Cup": 0.6, "Book": 0.24}, None),
        ({"Cup": 0.65, "Book": 0.25}, None),
        ({"Cup": 0.95}, "Cup"),
    ],
)
def test_a_class_contradicts_another_only_with_many_votes_against_few(shares, class_):
    update = told(voted(**shares), cup(class_="Book"))
    assert (update.class_ if update else None) == class_


@pytest.mark.parametrize(("share", "class_"), [(0.24, ANYTHING), (0.25, None), (0.39, None)])
def test_a_class_is_taken_back_with_few_votes_for_it(share, class_):
    update = told(voted(Cup=share))
    assert (update.class_ if update else None) == class_
    early = replace(voted(Cup=share), frames=CONFIG.confirm_frames - 1)
    assert told(early) is None or told(early).class_ is None


@pytest.mark.parametrize(
    ("where", "goes"),
    [
        (at(1.3, 1, 0.75), False),
        (at(1.0, 1.6, 0.75), False),
        (at(1.0, 1.9, 0.75), True),
        (at(1.0, 1.0, 0.15), True),
        (at(1.0, 1.0, 0.25), False),
    ],
)
def test_a_visible_neighbour_is_left_if_it_is_beside_or_above(where, goes):
    tray = entity("tray1", "Object", at(1, 1), (0.3, 0.12, 0.15), source="perception")
    other = entity("cup1", "Cup", where, SIZES["Cup"], source="perception")
    move = Update(name="tray1", at=(2.0, 1.0, 0.7))
    assert ("cup1" in (with_load(move, tray, [other, tray]).leave or ())) != goes
