from hypothesis import given
from hypothesis import strategies as st

from nodes.perception_node.kinship import ANYTHING, Kinship, Votes, kinship_of
from schemas.entities import ClassInfo
from tests.perception_node.things import KINSHIP

looks = st.lists(st.tuples(st.sampled_from(["Cup", "Tableware", "Bottle", "Object"]), st.floats(0.1, 1.0)))


def cast(*said):
    votes = Votes()
    for class_name, probability in said:
        votes = votes.cast(class_name, probability)
    return votes


def test_what_all_looks_say_is_believed():
    assert cast(("Cup", 0.9), ("Cup", 0.8)).belief(KINSHIP) == "Cup"


def test_where_looks_differ_what_they_have_in_common_is_believed():
    assert cast(*[("Cup", 0.9), ("Tableware", 0.9), ("Tableware", 0.9)]).belief(KINSHIP) == "Tableware"
    assert cast(*[("Cup", 0.9), ("Bottle", 0.9), ("Book", 0.9)]).belief(KINSHIP) == "Object"


def test_nothing_said_or_nothing_sure_is_any_object():
    assert Votes().belief(KINSHIP) == ANYTHING
    assert cast(("Cup", 0.3)).belief(KINSHIP) == ANYTHING


def test_new_looks_outweigh_old_ones():
    votes = cast(*[("Cup", 0.9)] * 10)
    for _ in range(20):
        votes = votes.cast("Bottle", 0.9)
    assert votes.belief(KINSHIP) == "Bottle"


@given(looks)
def test_a_class_has_no_more_of_the_votes_than_one_above_it(said):
    votes = cast(*said)
    shares = [votes.share(name, KINSHIP) for name in ("Cup", "Tableware", "Object")]
    assert shares == sorted(shares)
    assert 0.0 <= shares[0] <= shares[-1] <= 1.0 + 1e-9


def test_the_class_table_tells_the_hierarchy_and_the_labels():
    row = ClassInfo(
        name="Coffee_Cup",
        iri="http://example.org/Coffee_Cup",
        parents=("Cup",),
        ancestors=("Cup", "Object"),
        labels={"it": "tazzina", "en": "coffee cup"},
        spatial=True,
        place=False,
        fixed=False,
        model="",
    )
    kinship = kinship_of([row], {})
    assert kinship.is_a("Coffee_Cup", "Cup")
    assert not kinship.is_a("Cup", "Coffee_Cup")
    assert kinship.label("Coffee_Cup") == "coffee cup"
    assert Kinship().label("Coffee_Cup") == "coffee cup"
    assert Kinship().is_a("Coffee_Cup", "Object")
