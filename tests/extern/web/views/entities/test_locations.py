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


def test_an_entity_has_a_support_and_the_smallest_place():
    known = begun(
        fact("cup1", "isOn", "table1"),
        fact("cup1", "isLocatedIn", "flat1"),
        fact("cup1", "isLocatedIn", "kitchen1"),
    )
    assert known.find_support(CUP) == "table1"
    assert known.find_room(CUP, PLACES) == "kitchen1"
    assert known.find_places(CUP, PLACES) == {"flat1", "kitchen1"}


def test_a_container_precedes_a_support():
    known = begun(fact("cup1", "isOn", "bowl1"), fact("cup1", "isInside", "bowl1"))
    assert known.find_support(CUP) == "bowl1"


def test_unknown_locations_are_empty():
    assert begun().find_support(CUP) == ""
    assert begun().find_room(CUP, PLACES) == ""


def test_computed_facts_are_updated_by_commits():
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


def test_a_fact_that_changes_between_asserted_and_computed_stays():
    """A computed fact that is asserted is no longer computed: it is removed and inserted in one commit."""
    on = fact("cup1", "isOn", "table1")
    known = begun(on)
    known.apply(commit(went=[on], inserted=(on,)))
    assert known.find_support(CUP) == "table1"
    known.apply(commit(3, came=[on], retracted=(on,)))
    assert known.find_support(CUP) == "table1"


def test_denied_facts_do_not_hold_until_they_are_undenied():
    on = fact("cup1", "isOn", "table1")
    known = begun()
    known.apply(commit(inserted=(on,)))
    known.apply(commit(3, denied=[on]))
    assert known.find_support(CUP) == ""
    known.apply(commit(4, undenied=[on]))
    assert known.find_support(CUP) == "table1"


def test_a_fact_asserted_and_denied_in_one_commit_does_not_hold():
    on = fact("cup1", "isOn", "table1")
    known = begun()
    known.apply(commit(inserted=(on,), denied=[on]))
    assert known.find_support(CUP) == ""


def test_other_triples_change_nothing():
    known = begun()
    assert known.apply(commit(inserted=(fact("cup1", "hasColor", "red"),))) == frozenset()


def test_reset_removes_all_facts():
    known = begun(fact("cup1", "isOn", "table1"))
    known.reset([])
    assert known.find_support(CUP) == ""
