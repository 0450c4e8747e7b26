import pytest
from msgspec import structs

from semmap.nodes.extern.web.views.pending_moves import PendingMoves
from semmap.schemas import errors
from semmap.schemas.commands import Update
from tests.extern.web.views.sample_maps import by_name, thing

MAP = by_name(thing("a", at=(1.0, 1.0, 0.5)), thing("b", at=(0.0, 0.0, 0.0)), thing("idea", at=None))
RIGHT, LEFT, UP = (0.1, 0.0), (-0.1, 0.0), (0.0, 0.01)


@pytest.fixture
def moves():
    return PendingMoves()


def positions(moves, entities=MAP):
    return {name: pose.position_m for name, pose in moves.poses_after(entities).items()}


def moved(name, *at):
    return (Update(name=name, at=at, carry=True),)


def test_steps_of_one_selection_are_one_change(moves):
    for step in (RIGHT, RIGHT, UP):
        moves.add(("a", "b"), step)
    assert moves.is_first_open
    assert moves.presses == 3
    assert moves.take(MAP).changes == (*moved("a", 1.2, 1.01, 0.5), *moved("b", 0.2, 0.01, 0.0))
    assert moves.is_empty


def test_another_selection_begins_another_change_and_none_is_dropped(moves):
    moves.add(("a",), RIGHT)
    moves.close()
    assert not moves.is_first_open
    moves.add(("b",), UP)
    moves.close()
    moves.add(("a",), RIGHT)
    assert positions(moves) == {"a": pytest.approx((1.2, 1.0, 0.5)), "b": pytest.approx((0.0, 0.01, 0.0))}
    assert moves.take(MAP).changes == moved("a", 1.1, 1.0, 0.5)
    assert moves.take(MAP).changes == moved("b", 0.0, 0.01, 0.0)
    assert not moves.is_empty


def test_steps_after_a_sent_change_are_shown_from_its_positions(moves):
    moves.add(("a",), RIGHT)
    moves.take(MAP)
    assert positions(moves) == {"a": pytest.approx((1.1, 1.0, 0.5))}
    moves.add(("a",), RIGHT)
    after = by_name(thing("a", at=(1.1, 1.0, 0.5)))
    for entities in (MAP, after):  # before and after the map has the change
        assert positions(moves, entities) == {"a": pytest.approx((1.2, 1.0, 0.5))}
    moves.finish()
    assert positions(moves, after) == {"a": pytest.approx((1.2, 1.0, 0.5))}
    assert moves.take(after).changes == moved("a", 1.2, 1.0, 0.5)


def test_a_rejected_change_is_no_longer_shown(moves):
    moves.add(("a",), RIGHT)
    moves.take(MAP)
    moves.finish()
    assert positions(moves) == {}


def test_steps_that_cancel_one_another_are_not_sent(moves):
    moves.add(("a",), RIGHT)
    moves.add(("a",), LEFT)
    assert moves.take(MAP) is None
    assert positions(moves) == {}


@pytest.mark.parametrize("name", ["idea", "removed"])
def test_entities_without_a_position_are_an_error(moves, name):
    moves.add((name,), RIGHT)
    assert positions(moves) == {}
    with pytest.raises(errors.BadRequest, match="none of the selected entities has a position"):
        moves.take(MAP)
    assert moves.is_empty


def test_another_map_discards_the_steps(moves):
    moves.add(("a",), RIGHT)
    moves.take(MAP)
    moves.add(("a",), RIGHT)
    moves.clear()
    assert moves.is_empty
    assert positions(moves, by_name(structs.replace(MAP["a"], iri="urn:other"))) == {}
