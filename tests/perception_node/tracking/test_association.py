"""Association: identity survives moves, operators' statements stay, and resting things cause no updates."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec import structs

from semmap.nodes.perception_node.tracking.association import associate, rename_new_entity
from semmap.nodes.perception_node.tracking.tracks import Tracks
from semmap.schemas.commands import Add, Remove, Update
from semmap.schemas.perception import DISPLACED, MISSING
from tests.perception_node.things import CLASSES, CONFIG, SIZES, Table, at, entity, seen


def moved(thing, pose):
    return structs.replace(thing, pose=pose)


def test_a_new_thing_becomes_an_entity_after_enough_looks_and_only_once():
    table = Table([seen("Cup", at(1, 1))])
    assert table.observe(CONFIG.confirm_frames - 1) == []
    (add,) = table.look()
    assert isinstance(add, Add)
    assert (add.name, add.class_, add.ref, add.size) == ("cup1", "Cup", "cup", SIZES["Cup"])
    assert add.at == (1.0, 1.0, 0.7)
    assert add.confidence == pytest.approx(0.9)
    assert table.observe(20) == []
    assert table.taken_for == ("cup1",)


@pytest.mark.parametrize(
    ("thing", "frames"),
    [
        (seen("Cup", at(1, 1), p=0.9), 2),
        (seen("Cup", at(1, 1), p=0.7), 3),
        (seen("Cup", at(1, 1), p=0.9, whole=False), 3),
    ],
    ids=["clear", "of doubtful class", "cut by the picture's edge"],
)
def test_what_is_clear_is_an_entity_sooner(thing, frames):
    table = Table([thing], config=replace(CONFIG, clear_frames=2, clear=0.8))
    assert table.observe(frames - 1) == []
    assert len(table.look()) == 1


def test_what_flashes_up_or_moves_about_is_no_entity():
    table = Table()
    for step in range(20):
        table.things = [seen("Cup", at(1 + 0.05 * step, 1))]
        assert table.look() == ()
    table.things = []
    table.observe(6)
    assert table.tracks.tentative == ()


def test_a_thing_that_is_seen_in_every_other_frame_is_no_entity():
    cup, table = seen("Cup", at(1, 1)), Table()
    for look in range(60):
        table.things = [] if look % 2 else [cup]
        assert table.look() == ()
    table.things = [cup]
    assert len(table.observe(20)) == 1


@pytest.mark.parametrize("to", [at(1.06, 1), at(1.5, 1.2), at(4, -3), at(1, 1, 0.9)])
def test_identity_survives_a_move(to):
    table = Table([seen("Cup", at(1, 1)), seen("Cup", at(1.5, 1.5)), seen("Book", at(0.5, 1))])
    table.observe(5)
    names = dict(zip(table.taken_for, table.things, strict=True))
    table.things[0] = moved(table.things[0], to)
    (update,) = table.observe(20)
    assert isinstance(update, Update)
    assert names[update.name].pose == at(1, 1)
    assert update.at == pytest.approx(to.position_m)
    assert len(table.entities) == 3


def test_a_thing_whose_yaw_nobody_can_tell_has_moved_all_the_same():
    table = Table([seen("Book", at(1, 1))])
    table.observe(5)
    told = []
    for look in range(4):
        table.things = [seen("Book", at(2, 1, yaw=0.8 * (look % 2)))]
        told += table.look()
    assert [command.name for command in told] == ["book1"]


def test_a_thing_on_its_way_is_followed_and_told_when_it_rests():
    table = Table([seen("Cup", at(1, 1))])
    table.observe(5)
    for step in range(1, 10):
        table.things = [seen("Cup", at(1 + 0.1 * step, 1))]
        assert table.look() == ()
    (update,) = table.observe(5)
    assert (update.name, update.at) == ("cup1", pytest.approx((1.9, 1.0, 0.7)))


def test_a_thing_that_comes_to_stand_in_anothers_place_keeps_its_name_and_so_does_the_other():
    table = Table([seen("Cup", at(1, 1)), seen("Bottle", at(2, 1))])
    table.observe(5)
    table.things = [seen("Bottle", at(1, 1))]  # and the cup is not visible
    table.observe(2)
    assert table.taken_for == ("bottle1",)
    assert table.entities["bottle1"].pose == at(1, 1)
    table.things = [seen("Bottle", at(1, 1)), seen("Cup", at(3, 1))]
    table.observe(3)
    assert table.taken_for == ("bottle1", "cup1")
    assert table.entities["cup1"].pose == at(3, 1)


def test_a_thing_that_was_carried_out_of_sight_for_a_moment_keeps_its_name():
    table = Table([seen("Cup", at(1, 1))])
    table.observe(5)
    table.things = []
    assert table.observe(CONFIG.gone_frames - 1) == []
    table.things = [seen("Cup", at(2, 1))]
    assert [command.name for command in table.observe(5)] == ["cup1"]


def test_perceptions_own_leaves_the_map_when_its_place_is_seen_empty():
    table = Table([seen("Cup", at(1, 1))])
    table.observe(5)
    table.things = []
    (remove,) = table.observe(20)
    assert isinstance(remove, Remove)
    assert remove.names == ("cup1",)


def test_or_is_marked_by_option_and_the_mark_goes_when_it_is_back():
    table = Table([seen("Cup", at(1, 1))], config=replace(CONFIG, when_gone="mark"))
    table.observe(5)
    table.things = []
    assert [command.conflict for command in table.observe(20)] == [MISSING]
    table.things = [seen("Cup", at(1, 1))]
    assert [command.conflict for command in table.observe(20)] == [""]


def test_an_operators_is_marked_missing_and_found_elsewhere():
    table = Table().told([entity("my_cup", "Cup", at(1, 1))])
    assert [command.conflict for command in table.observe(20)] == [MISSING]
    table.things = [seen("Cup", at(3, 1))]
    (update,) = table.observe(20)
    assert (update.name, update.at, update.conflict) == ("my_cup", (3.0, 1.0, 0.7), "")


def test_an_operators_thing_of_unknown_size_is_looked_for_at_its_classs_usual_size_if_there_is_one():
    table = Table().told(
        [structs.replace(entity(name, kind, at(x, 1)), size_m=None) for name, kind, x in
         (("my_cup", "Cup", 1), ("my_thing", "Object", 2))]
    )  # fmt: skip
    assert [(command.name, command.conflict) for command in table.observe(20)] == [("my_cup", MISSING)]


def test_what_is_hidden_stays():
    table = Table([seen("Cup", at(1, 1))])
    table.observe(5)
    table.things, table.hidden = [], True
    assert table.observe(50) == []


def test_a_name_is_not_given_twice():
    table = Table([seen("Cup", at(1, 1))])
    table.observe(5)
    table.things = []
    table.observe(20)
    table.things = [seen("Cup", at(1, 1))]
    assert [command.name for command in table.observe(20)] == ["cup2"]


def test_a_new_process_takes_perceptions_own_from_the_map_and_goes_on():
    table = Table([seen("Cup", at(1, 1)), seen("Cup", at(2, 1)), seen("Book", at(3, 1))])
    table.observe(5)
    names = table.taken_for
    table.tracks = Tracks()
    assert table.look() == ()
    assert table.taken_for == names
    table.things[0] = moved(table.things[0], at(1.5, 2))
    assert [command.name for command in table.observe(20)] == [names[0]]
    table.tracks = Tracks()
    del table.things[1]
    assert [command.names for command in table.observe(20)] == [(names[1],)]


def test_a_new_process_does_not_forget_at_its_first_looks_what_a_thing_was_taken_for():
    table = Table([seen("Tableware", at(1, 1), SIZES["Cup"])])
    table.observe(20)
    table.tracks = Tracks()
    table.things = [seen("Cup", at(1, 1))]
    assert table.observe(CONFIG.confirm_frames) == []


def test_a_name_that_was_given_before_is_exchanged():
    table = Table([seen("Cup", at(1, 1)), seen("Cup", at(2, 1)), seen("Book", at(3, 1))])
    adds = table.observe(CONFIG.confirm_frames)
    tracks, add = rename_new_entity(table.tracks, adds[0], table.entities)
    assert (add.name, add.reason) == ("cup3", "cup3 was seen")
    assert add.at == adds[0].at
    assert tracks.known == {
        "cup3": table.tracks.known["cup1"],
        **{name: table.tracks.known[name] for name in ("cup2", "book1")},
    }
    assert tracks.names == {"cup1", "cup2", "cup3", "book1"}


SIDE_BY_SIDE = (0.35, 0.08, 0.1)
"""The box of two cups at a distance of 0.27 m."""


def test_two_things_that_are_seen_as_one_stay_what_they_are_however_long():
    table = Table([seen("Cup", at(1, 1)), seen("Cup", at(1.27, 1))])
    table.observe(5)
    apart = table.things
    table.things = [seen("Object", at(1.135, 1), SIDE_BY_SIDE)]
    assert table.observe(3 * CONFIG.odd_frames) == []
    table.things = apart
    assert table.observe(20) == []


def test_what_came_to_stand_beside_another_is_told_once_it_was_seen_apart_from_it():
    table = Table([seen("Cup", at(1, 1)), seen("Cup", at(3, 1))])
    table.observe(5)
    table.things[1] = moved(table.things[1], at(1.27, 1))
    assert table.look() == ()
    table.things = [seen("Object", at(1.135, 1), SIDE_BY_SIDE)]
    (update,) = table.observe(20)
    assert (update.name, update.at) == ("cup2", pytest.approx((1.27, 1.0, 0.7)))


def test_one_look_at_it_with_its_neighbour_does_not_change_its_size():
    table = Table([seen("Cup", at(1, 1))])
    table.observe(20)
    table.things = [seen("Cup", at(2, 1), (0.08, 0.1, 0.1))]
    table.look()
    assert table.tracks.known["cup1"].size_m == pytest.approx(SIZES["Cup"], abs=0.002)


def test_what_comes_to_stand_where_another_has_left_is_the_one_that_it_is_most_like():
    """The thing that left that place is less similar."""
    table = Table([seen("Object", at(1, 1), (0.08, 0.09, 0.12)), seen("Cup", at(2, 1))])
    table.observe(5)
    object_, cup = table.things
    table.things = [cup]
    table.look()
    table.things = [moved(cup, at(1, 1))]
    assert [command.name for command in table.observe(2)] == ["cup1"]
    table.things = [moved(cup, at(1, 1)), moved(object_, at(2, 1))]
    assert [command.name for command in table.observe(2)] == ["object1"]


def test_a_big_thing_whose_box_holds_small_ones_is_new():
    table = Table([seen("Cup", at(1, 1)), seen("Cup", at(1.2, 1.1))])
    table.observe(5)
    table.things.append(seen("Object", at(1.1, 1, 0.0), (1.0, 0.8, 0.8)))
    assert [command.name for command in table.observe(20)] == ["object1"]


def test_something_else_in_its_place_is_something_else():
    table = Table([seen("Cup", at(1, 1))])
    table.observe(5)
    table.things = [seen("Bottle", at(1, 1))]
    commands = table.observe(20)
    assert [type(command) for command in commands] == [Remove, Add]
    assert {e.class_ for e in table.entities.values()} == {"Bottle"}


def test_a_closer_look_makes_perceptions_own_class_more_special_and_an_unsure_one_changes_nothing():
    table = Table([seen("Tableware", at(1, 1), SIZES["Cup"])])
    table.observe(5)
    table.things = [seen("Cup", at(1, 1))]
    (update,) = table.observe(30)
    assert (update.class_, update.ref) == ("Cup", "cup")
    table.things = [seen("Tableware", at(1, 1), SIZES["Cup"])]
    assert table.observe(30) == []


def test_what_contradicts_an_operator_is_kept_beside_his_word():
    table = Table([seen("Bottle", at(1, 1), SIZES["Cup"])]).told([entity("my_cup", "Cup", at(1, 1))])
    (update,) = table.observe(30)
    assert (update.name, update.conflict) == ("my_cup", "looks like a Bottle")
    assert table.entities["my_cup"].class_ == "Cup"
    table.things = [seen("Cup", at(1, 1))]
    assert [command.conflict for command in table.observe(50)] == [""]


def test_where_an_operator_said_no_size_a_thing_of_any_size_may_be_what_he_meant():
    my_cup = structs.replace(entity("my_cup", "Cup", at(1, 1)), size_m=None)
    table = Table([seen("Bottle", at(1, 1))]).told([my_cup])
    assert [(command.name, command.conflict) for command in table.observe(30)] == [
        ("my_cup", "looks like a Bottle")
    ]


def test_what_perception_took_for_something_else_is_put_right():
    table = Table([seen("Bottle", at(1, 1), SIZES["Cup"])])
    table.observe(5)
    table.things = [seen("Cup", at(1, 1))]
    (update,) = table.observe(50)
    assert (update.name, update.class_) == ("bottle1", "Cup")


def test_a_half_hidden_thing_has_not_moved_nor_shrunk():
    table = Table([seen("Bottle", at(1, 1))])
    table.observe(5)
    table.things = [seen("Bottle", at(1.01, 1, 0.8), (0.03, 0.07, 0.12), whole=False)]
    assert table.observe(20) == []


def test_more_of_it_seen_makes_it_bigger():
    table = Table([seen("Book", at(1, 1), (0.16, 0.2, 0.03), whole=False)])
    table.observe(5)
    table.things = [seen("Book", at(1, 1), (0.16, 0.3, 0.03))]
    updates = table.observe(30)
    assert updates
    assert table.entities["book1"].size_m == pytest.approx((0.16, 0.3, 0.03), abs=0.05)
    assert table.observe(30) == []


def test_a_box_turned_by_a_quarter_with_its_sides_exchanged_is_the_same_box():
    table = Table([seen("Book", at(1, 1, yaw=0.1))])
    table.observe(5)
    x, y, z = SIZES["Book"]
    table.things = [seen("Book", at(1, 1, yaw=0.1 + 1.5708), (y, x, z))]
    assert table.observe(10) == []
    table.things = [seen("Book", at(1, 1, yaw=0.9))]
    (update,) = table.observe(10)
    assert update.at == pytest.approx((1.0, 1.0, 0.7))


def test_an_operators_new_pose_counts_until_something_else_is_seen():
    table = Table([seen("Cup", at(1, 1))])
    table.observe(5)
    table.entities["cup1"] = structs.replace(table.entities["cup1"], pose=at(5, 5))
    (update,) = table.observe(20)
    assert (update.name, update.at) == ("cup1", pytest.approx((1.0, 1.0, 0.7)))


def test_places_and_things_without_a_position_are_none_of_perceptions_business():
    table = Table().told([entity("kitchen1", "Cup", at(1, 1), place=True), entity("my_cup", "Cup", None)])
    assert table.observe(20) == []


cells = st.tuples(st.integers(-4, 4), st.integers(-4, 4))
kinds = st.sampled_from(sorted(SIZES))
layouts = st.dictionaries(cells, kinds, max_size=8)


def things_of(layout):
    return [seen(kind, at(0.6 * x, 0.6 * y)) for (x, y), kind in layout.items()]


def entities_of(layout, source):
    return [entity(f"{source}_{x}_{y}".replace("-", "m"), kind, at(0.6 * x, 0.6 * y), source=source)
            for (x, y), kind in layout.items()]  # fmt: skip


@settings(deadline=None, max_examples=40)
@given(layouts, layouts, layouts)
def test_whatever_is_seen_and_said_the_map_comes_to_rest_and_holds_what_is_there(there, said, believed):
    """The table asserts that names are unique, and that no operator's entity is removed or renamed."""
    operators = {cell: kind for cell, kind in said.items() if cell not in believed}
    table = Table(things_of(there)).told(
        [*entities_of(operators, "operator"), *entities_of(believed, "perception")]
    )
    table.observe(40)
    assert table.observe(5) == []
    assert all(table.taken_for)
    assert len(set(table.taken_for)) == len(there)
    standing = {thing.pose for thing in table.things}
    unseen = [e for name, e in table.entities.items() if name not in table.taken_for]
    assert all(e.shape_provenance.source == "operator" for e in unseen)
    assert all(e.conflict == MISSING for e in unseen if e.pose not in standing)
    assert all(e.conflict in (MISSING, DISPLACED) for e in unseen if e.pose in standing)


@settings(deadline=None, max_examples=40)
@given(layouts, st.lists(st.tuples(st.integers(0, 7), cells), max_size=6))
def test_every_thing_keeps_its_name_through_any_moves_to_free_places(layout, moves):
    table = Table(things_of(layout))
    table.observe(5)
    names = table.taken_for
    for which, (x, y) in moves if layout else []:
        free = {thing.pose.position_m[:2] for thing in table.things}
        to = at(0.6 * x, 0.6 * y)
        if to.position_m[:2] not in free:
            index = which % len(table.things)
            table.things[index] = moved(table.things[index], to)
            table.observe(4)
    assert table.taken_for == names


@settings(deadline=None, max_examples=40)
@given(layouts, st.lists(st.floats(-0.007, 0.007), min_size=60, max_size=60))
def test_noise_is_no_news(layout, noise):
    table = Table(things_of(layout))
    still = list(table.things)
    wobble = iter(noise * 20)
    for look in range(15):
        table.things = [
            moved(thing, at(thing.pose.position_m[0] + next(wobble), thing.pose.position_m[1] + next(wobble)))
            for thing in still
        ]
        commands = table.look()
        assert not commands or look == CONFIG.confirm_frames - 1


def test_what_is_moved_takes_along_what_cannot_be_seen():
    """A book with two cups on it is moved: one cup is visible there, the other is hidden."""
    table = Table([seen("Book", at(1, 1)), seen("Cup", at(1, 1.05, 0.73)), seen("Bottle", at(1.3, 1))])
    hidden = entity("hidden_cup", "Cup", at(1, 0.95, 0.73))
    table.observe(5)
    table.told([hidden])
    table.things[:2] = [seen("Book", at(3, 2)), seen("Cup", at(3, 2.05, 0.73))]
    moves = {command.name: command for command in table.observe(3)}
    assert set(moves) == {"book1", "cup1"}
    assert moves["book1"].carry
    assert set(moves["book1"].leave) == {"cup1", "bottle1"}


def test_what_stays_behind_is_left_there():
    table = Table([seen("Book", at(1, 1)), seen("Cup", at(1, 1, 0.73))])
    table.observe(5)
    table.things = [seen("Book", at(3, 2)), seen("Cup", at(1, 1, 0.7))]
    (moved,) = (command for command in table.observe(3) if command.name == "book1")
    assert (moved.carry, moved.leave) == (True, ("cup1",))


def test_what_does_not_move_carries_nothing():
    table = Table().told([entity("my_cup", "Cup", at(1, 1))])
    (update,) = table.observe(20)
    assert not update.carry


def test_what_others_moved_is_looked_for_anew():
    """That it is absent from its old place does not indicate its new place."""
    table = Table().told([entity("my_cup", "Cup", at(1, 1))])
    assert table.observe(CONFIG.gone_frames - 1) == []
    table.told([entity("my_cup", "Cup", at(3, 2))])
    table.hidden = True
    assert table.observe(20) == []


def test_what_stood_elsewhere_already_is_not_the_one_that_has_gone():
    table = Table([seen("Cup", at(1, 1))])
    table.observe(5)
    table.things.append(seen("Cup", at(3, 1)))
    table.look()
    del table.things[0]
    commands = table.observe(20)
    assert [type(command) for command in commands] == [Add, Remove]
    assert list(table.entities) == ["cup2"]


@pytest.mark.parametrize(("config", "frames"), [(CONFIG, 1), (CONFIG.for_moving_camera, 3)])
def test_a_moving_camera_looks_longer_before_it_takes_one_thing_for_another(config, frames):
    table = Table([seen("Cup", at(1, 1))], config=config)
    table.observe(8)
    table.things = [seen("Cup", at(3, 1))]
    table.observe(frames - 1)
    assert table.taken_for == (("",) if frames > 1 else ("cup1",))
    table.look()
    assert table.taken_for == ("cup1",)


@pytest.mark.parametrize(
    ("config", "names"), [(CONFIG, ["object1"]), (CONFIG.for_moving_camera, ["object2"])]
)
def test_to_a_moving_camera_a_chair_two_metres_from_one_that_has_gone_is_another(config, names):
    chair_m = (0.45, 0.45, 0.9)
    table = Table([seen("Object", at(1, 1, 0.0), chair_m)], config=config)
    table.observe(8)
    table.things = [seen("Object", at(3, 1, 0.0), chair_m)]
    table.observe(20)
    assert list(table.entities) == names


def test_what_is_pushed_along_keeps_its_name_even_to_a_moving_camera():
    chair_m = (0.45, 0.45, 0.9)
    table = Table([seen("Object", at(1, 1, 0.0), chair_m)], config=CONFIG.for_moving_camera)
    table.observe(8)
    table.things = [seen("Object", at(1.5, 1, 0.0), chair_m)]
    table.observe(20)
    assert list(table.entities) == ["object1"]


def test_a_part_becomes_an_entity_later_and_is_put_right_when_the_whole_is_seen():
    table = Table([seen("Book", at(1, 1), (0.16, 0.2, 0.03), whole=False)], config=CONFIG.for_moving_camera)
    assert table.observe(CONFIG.for_moving_camera.part_frames - 1) == []
    assert len(table.look()) == 1
    table.things = [seen("Book", at(1, 1.06), (0.16, 0.32, 0.03))]
    (update,) = table.observe(2)
    assert (update.at, update.size) == ((1.0, 1.06, 0.7), (0.16, 0.32, 0.03))
    assert table.observe(20) == []


@pytest.mark.parametrize(
    ("shown", "unseen"),
    [
        (seen("Object", at(1.03, 1), (0.2, 0.1, 0.3), whole=False), 0),
        (seen("Cup", at(1.03, 1), (0.2, 0.1, 0.3)), 1),
    ],
    ids=["cut by the picture's edge", "another thing"],
)
def test_a_place_in_which_a_part_is_seen_is_not_empty_though_a_camera_looks_through_it(shown, unseen):
    table = Table([seen("Bottle", at(1, 1), (0.3, 0.3, 0.9))])
    table.observe(5)
    told = associate(table.entities, table.tracks, [shown], lambda *_: "free", CLASSES, CONFIG)
    assert told.tracks.known["bottle1"].unseen == unseen


@pytest.mark.parametrize(("x", "added"), [(1.21, False), (1.5, True)])
def test_a_leg_of_a_known_thing_is_no_new_entity(x, added):
    leg = seen("Cup", at(x, x, 0.0), (0.04, 0.04, 0.16))
    table = Table([leg], hidden=True).told([entity("chair1", "Object", at(1, 1, 0.0), (0.45, 0.45, 0.9))])
    assert any(isinstance(command, Add) for command in table.observe(CONFIG.confirm_frames)) is added


@pytest.mark.parametrize("size_m", [(1.4, 0.6, 0.9), None], ids=["of a size in the map", "of unknown size"])
def test_a_thing_has_not_moved_where_its_place_is_still_filled(size_m):
    """A counter is next to another of the same height: the current observation is a part of both."""
    table = Table([seen("Object", at(1, 1, 0.0), (1.4, 0.6, 0.9))])
    table.observe(5)
    table.told([structs.replace(table.entities["object1"], size_m=size_m)])
    rest = seen("Bottle", at(0.5, 1, 0.0), (0.4, 0.6, 0.9))
    table.things = [seen("Object", at(1.4, 1, 0.0), (1.4, 0.6, 0.9)), rest]
    told = table.observe(table.config.kept_frames - 2)
    assert [c for c in told if isinstance(c, Update)] == []
    assert table.entities["object1"].pose == at(1, 1, 0.0)


def test_a_thing_that_was_pushed_along_has_moved():
    table = Table([seen("Object", at(1, 1, 0.0), (1.4, 0.6, 0.9))])
    table.observe(5)
    table.things = [seen("Object", at(1.4, 1, 0.0), (1.4, 0.6, 0.9))]
    (update,) = table.observe(10)
    assert update.at == pytest.approx((1.4, 1.0, 0.0))


def test_what_is_like_nothing_known_from_near_is_an_object():
    table = Table([structs.replace(seen("Bottle", at(1, 1), SIZES["Cup"]), points=100)])
    table.observe(5)
    table.things = [structs.replace(seen("Object", at(1, 1), SIZES["Cup"]), points=9000)]
    (update,) = table.observe(30)
    assert (update.name, update.class_) == ("bottle1", "Object")
    assert table.entities["bottle1"].class_ == "Object"


def test_what_turns_out_to_be_a_leg_is_no_entity_any_more():
    table = Table([seen("Cup", at(1.21, 1.21, 0.0), (0.04, 0.04, 0.16))], hidden=True)
    table.observe(5)
    assert set(table.entities) == {"cup1"}
    table.told([entity("chair1", "Object", at(1, 1, 0.0), (0.45, 0.45, 0.9))])
    (remove,) = table.observe(10)
    assert (remove.names, remove.reason) == (("cup1",), "cup1 is a leg of chair1")
    my_cup = entity("my_cup", "Cup", at(1.21, 1.21, 0.0), (0.04, 0.04, 0.16))
    assert table.told([my_cup]).observe(10) == []


def test_a_class_is_withdrawn_for_one_above_it_that_looks_tell_from_it():
    classes = replace(CLASSES, ancestors=CLASSES.ancestors | {"Mug": CLASSES.ancestors["Cup"] | {"Cup"}})
    mug = entity("mug1", "Mug", at(1, 1), SIZES["Cup"], source="perception", confidence=0.6)
    entities, tracks, told = {"mug1": mug}, Tracks(), []
    for _ in range(40):
        found = associate(entities, tracks, [seen("Cup", at(1, 1))], lambda *_: "free", classes, CONFIG)
        tracks = found.tracks
        told += found.commands
        if told:
            break
    assert [(command.name, command.class_) for command in told] == [("mug1", "Cup")]


def test_a_plate_that_was_measured_five_times_too_high_keeps_its_name():
    table = Table([seen("Object", at(1, 1), (0.28, 0.29, 0.12))])
    table.observe(4)
    table.things = [seen("Object", at(1.01, 1.01), (0.25, 0.27, 0.018))]
    (resized,) = table.observe(CONFIG.odd_frames + 2 * CONFIG.nudge_frames)
    assert (resized.name, resized.size) == ("object1", (0.25, 0.27, 0.018))
    assert table.observe(2 * CONFIG.odd_frames) == []
    assert table.taken_for == ("object1",)


def test_a_narrower_thing_in_the_place_of_another_is_another():
    table = Table([seen("Object", at(1, 1), (0.28, 0.29, 0.12))])
    table.observe(4)
    table.things = [seen("Object", at(1.01, 1.01), (0.16, 0.17, 0.018))]
    remove, add = table.observe(CONFIG.odd_frames + 2 * CONFIG.nudge_frames)
    assert isinstance(remove, Remove)
    assert add.name == "object2"


def two_cups_as_one(class_: str) -> Table:
    """A table on which a cup was seen partially, then once merged with its neighbour, then as before."""
    part = seen("Cup", at(1, 1), whole=False)
    table = Table([part])
    table.observe(5)
    table.things = [seen(class_, at(1.0, 1.06), (0.08, 0.2, 0.1))]
    table.look()
    table.things, table.hidden = [part], True
    table.observe(5)
    return table


def test_what_was_once_seen_with_its_neighbour_is_put_right_by_what_the_pictures_edge_cuts():
    cup = two_cups_as_one("Tableware").entities["cup1"]
    assert cup.pose.position_m == pytest.approx((1.0, 1.0, 0.7))
    assert cup.size_m == SIZES["Cup"]


def test_a_thing_that_is_larger_than_most_of_its_class_is_not_cut_down_by_a_part_of_it():
    cup = two_cups_as_one("Cup").entities["cup1"]
    assert cup.pose.position_m == pytest.approx((1.0, 1.06, 0.7))
    assert cup.size_m == (0.08, 0.2, 0.1)


def test_what_an_operator_says_of_a_size_is_not_put_right_by_what_the_pictures_edge_cuts():
    table = Table([seen("Tableware", at(1, 1), (0.08, 0.3, 0.1))])
    table.told([entity("cup1", "Cup", at(1, 1), (0.08, 0.3, 0.1))])
    table.observe(5)
    table.things, table.hidden = [seen("Cup", at(1, 1.06), whole=False)], True
    assert table.observe(20) == []


def test_a_thing_that_moves_in_front_of_its_place_keeps_its_name():
    table = Table([seen("Bottle", at(1, 1))])
    table.observe(5)
    table.things, table.hidden = [seen("Bottle", at(1, 0.82))], True
    (update,) = table.observe(10)
    assert (update.name, update.at) == ("bottle1", pytest.approx((1.0, 0.82, 0.7)))
    assert list(table.entities) == ["bottle1"]


@pytest.mark.parametrize(
    "other",
    [
        seen("Bottle", at(1, 0.5)),
        seen("Bottle", at(1, 0.82), (0.1, 0.1, 0.4)),
        seen("Cup", at(1, 0.82)),
        structs.replace(seen("Bottle", at(1, 0.82)), color_rgb=(0.1, 0.2, 0.8)),
    ],
    ids=["far", "larger", "of another class", "of another colour"],
)
def test_another_thing_in_front_of_a_hidden_one_is_new(other):
    table = Table([structs.replace(seen("Bottle", at(1, 1)), color_rgb=(0.8, 0.2, 0.1))])
    table.observe(5)
    table.things, table.hidden = [other], True
    (add,) = table.observe(10)
    assert isinstance(add, Add)


@pytest.mark.parametrize(
    "other",
    [
        seen("Object", at(2.9, 1), (0.15, 0.06, 0.15), whole=False),
        structs.replace(seen("Object", at(2.9, 1)), color_rgb=(0.1, 0.2, 0.8)),
    ],
    ids=["partly visible", "of another colour"],
)
def test_an_unknown_thing_is_not_recognised_in_a_different_one(other):
    table = Table([structs.replace(seen("Object", at(1, 1)), color_rgb=(0.8, 0.2, 0.1))])
    table.observe(5)
    table.things = [other]
    table.observe(20)
    assert "object1" not in table.entities


def test_a_thing_of_no_known_class_is_looked_at_longer():
    table = Table([seen("Object", at(1, 1))], config=replace(CONFIG, vague_frames=6))
    assert table.observe(5) == []
    assert len(table.look()) == 1
