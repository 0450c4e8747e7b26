import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.perception_node.tracking.class_hierarchy import ANYTHING
from semmap.nodes.perception_node.tracking.votes import Votes
from tests.perception_node.things import CLASSES

frames = st.lists(st.tuples(st.sampled_from(["Cup", "Tableware", "Bottle", "Object"]), st.floats(0.1, 1.0)))


def cast(*said):
    votes = Votes()
    for class_name, probability in said:
        votes = votes.cast(class_name, probability)
    return votes


def test_what_all_looks_say_is_believed():
    assert cast(("Cup", 0.9), ("Cup", 0.8)).belief(CLASSES) == "Cup"


def test_where_looks_differ_what_they_have_in_common_is_believed():
    assert cast(*[("Cup", 0.9), ("Tableware", 0.9), ("Tableware", 0.9)]).belief(CLASSES) == "Tableware"
    assert cast(*[("Cup", 0.9), ("Bottle", 0.9), ("Book", 0.9)]).belief(CLASSES) == "Object"


def test_nothing_said_or_nothing_sure_is_any_object():
    assert Votes().belief(CLASSES) == ANYTHING
    assert cast(("Cup", 0.3)).belief(CLASSES) == ANYTHING


def test_new_looks_outweigh_old_ones():
    votes = cast(*[("Cup", 0.9)] * 10)
    for _ in range(20):
        votes = votes.cast("Bottle", 0.9)
    assert votes.belief(CLASSES) == "Bottle"


@given(frames)
def test_a_class_has_no_more_of_the_votes_than_one_above_it(said):
    votes = cast(*said)
    shares = [votes.share(name, CLASSES) for name in ("Cup", "Tableware", "Object")]
    assert shares == sorted(shares)
    assert 0.0 <= shares[0] <= shares[-1] <= 1.0 + 1e-9


def test_the_votes_for_a_class_are_moved_to_another_one():
    votes = cast(("Cup", 0.5), ("Bottle", 0.8))
    moved = votes.moved("Cup", "Bottle")
    assert moved.weights == {"Bottle": votes.weights["Cup"] + votes.weights["Bottle"]}
    assert moved.frames == votes.frames
    assert votes.moved("Cup", "Book").share("Book", CLASSES) == votes.share("Cup", CLASSES)
    assert votes.moved("Book", "Cup").share("Cup", CLASSES) == votes.share("Cup", CLASSES)


def test_remembered_votes_are_as_sure_as_they_were():
    votes = Votes.remembered("Cup", 0.7)
    assert votes.share("Cup", CLASSES) == 0.7
    assert Votes().share("Cup", CLASSES) == 0.0
    assert 0.6 < votes.cast("Bottle", 0.9).share("Cup", CLASSES) < 0.7


def test_a_look_that_is_worth_more_outweighs_others():
    votes = cast(*[("Cup", 0.9)] * 4).cast("Bottle", 0.9, 8.0)
    assert votes.belief(CLASSES) == "Bottle"
    assert cast(*[("Cup", 0.9)] * 4).cast("Bottle", 0.9).belief(CLASSES) == "Cup"


def test_old_votes_are_forgotten_however_many_names_there_are():
    votes = Votes()
    for number in range(1000):
        votes = votes.cast(f"a mug, frame {number}", 1.0)
    assert len(votes.weights) < 100


@pytest.mark.parametrize(("probability", "belief"), [(0.4, "Cup"), (0.39, ANYTHING)])
def test_a_class_is_believed_from_two_fifths_of_the_votes(probability, belief):
    assert cast(("Cup", probability)).belief(CLASSES) == belief


@pytest.mark.parametrize(("probability", "winner"), [(0.6, "Cup"), (0.59, None)])
def test_a_clear_winner_has_three_fifths_of_the_votes(probability, winner):
    assert cast(("Cup", probability)).clear_winner == winner
    assert Votes().clear_winner is None


def test_a_vote_loses_a_tenth_with_each_later_one():
    votes = cast(("Cup", 0.8), ("Bottle", 0.5), ("Bottle", 0.5))
    assert votes.weights == pytest.approx({"Cup": 0.8 * 0.81, "Bottle": 0.5 * 0.9 + 0.5})
    assert votes.frames == pytest.approx(1.0 + 0.9 + 0.81)


@pytest.mark.parametrize(("weight", "stays"), [(1.1e-4, True), (0.9e-4, False)])
def test_a_vote_of_nearly_no_weight_is_dropped(weight, stays):
    assert ("Cup" in Votes({"Cup": weight}, 1.0).cast("Bottle", 0.5).weights) == stays


def test_of_equally_deep_classes_the_one_with_more_votes_is_believed():
    assert cast(("Bottle", 0.9), ("Book", 0.9)).belief(CLASSES) == "Book"
    assert cast(("Book", 0.9), ("Bottle", 0.9)).belief(CLASSES) == "Bottle"
