from semmap.nodes.extern.web.views.entities.locations import Locations
from tests.extern.web.views.sample_maps import by_name, commit, fact, place, thing

FLAT = place("flat1", (10.0, 8.0, 2.5))
KITCHEN = place("kitchen1")
CUP = thing("cup1")
PLACES = by_name(FLAT, KITCHEN)


def begun(*facts):
    locations = Locations()
    locations.reset(facts)
    return locations


def test_a_thing_is_on_its_bearer_and_in_the_smallest_place():
    known = begun(
        fact("cup1", "isOn", "table1"),
        fact("cup1", "isLocatedIn", "flat1"),
        fact("cup1", "isLocatedIn", "kitchen1"),
    )
    assert known.find_support(CUP) == "table1"
    assert known.find_room(CUP, PLACES) == "kitchen1"
    assert known.find_places(CUP, PLACES) == {"flat1", "kitchen1"}


def test_what_is_inside_something_is_told_by_that():
    known = begun(fact("cup1", "isOn", "bowl1"), fact("cup1", "isInside", "bowl1"))
    assert known.find_support(CUP) == "bowl1"


def test_nothing_is_known_of_what_nobody_spoke_of():
    assert begun().find_support(CUP) == ""
    assert begun().find_room(CUP, PLACES) == ""


def test_measured_facts_come_and_go_with_commits():
    known = begun(fact("cup1", "isOn", "table1"), fact("cup1", "isLocatedIn", "kitchen1"))
    touched = known.apply(
        commit(
            came=[fact("cup1", "isOn", "desk1")],
            went=[fact("cup1", "isOn", "table1"), fact("cup1", "isLocatedIn", "kitchen1")],
        )
    )
    assert touched == {"cup1"}
    assert known.find_support(CUP) == "desk1"
    assert known.find_room(CUP, PLACES) == ""


def test_what_is_asserted_and_measured_at_once_stays_when_it_goes_from_one_to_the_other():
    """A measured fact that somebody asserts is no longer computed: it went, and was inserted."""
    on = fact("cup1", "isOn", "table1")
    known = begun(on)
    known.apply(commit(went=[on], inserted=(on,)))
    assert known.find_support(CUP) == "table1"
    known.apply(commit(3, came=[on], retracted=(on,)))
    assert known.find_support(CUP) == "table1"


def test_what_geometry_denies_does_not_count_until_it_no_longer_does():
    on = fact("cup1", "isOn", "table1")
    known = begun()
    known.apply(commit(inserted=(on,)))
    known.apply(commit(3, denied=[on]))
    assert known.find_support(CUP) == ""
    known.apply(commit(4, undenied=[on]))
    assert known.find_support(CUP) == "table1"


def test_what_is_asserted_and_denied_in_one_commit_does_not_count():
    on = fact("cup1", "isOn", "table1")
    known = begun()
    known.apply(commit(inserted=(on,), denied=[on]))
    assert known.find_support(CUP) == ""


def test_other_triples_touch_nothing():
    known = begun()
    assert known.apply(commit(inserted=(fact("cup1", "hasColor", "red"),))) == frozenset()


def test_beginning_again_forgets():
    known = begun(fact("cup1", "isOn", "table1"))
    known.reset([])
    assert known.find_support(CUP) == ""
