"""`semmap list --on` with a suppressed fact about places, through a whole system."""

import pytest

from semmap.ontology import HOUSEHOLD_TTL

ON_SHELVES = """
dm:Milk rdfs:subClassOf [ a owl:Restriction ; owl:onProperty dm:isOn ; owl:allValuesFrom dm:Shelf ] .
dm:Shelf owl:disjointWith dm:Counter .
"""


@pytest.fixture(scope="module")
def system(empty_map):
    with empty_map.client() as client:
        client.add("Counter", "counter1", at=(0.0, 0.0, 0.0))
        client.add("Milk", "milk1", at=(0.0, 0.0, 0.9))
    return empty_map


def test_a_list_that_lacks_something_withheld_says_so(system, tmp_path):
    choosy = tmp_path / "choosy.ttl"
    choosy.write_text(HOUSEHOLD_TTL.read_text() + ON_SHELVES)
    system.cli("load", "--tbox", choosy)
    told = system.cli("list", "--on", "counter1")
    note = "note: relations of counter1 that contradict the map are suppressed; see: semmap check\n"
    assert told == f"0 entities\n{note}"
    assert (
        "'milk1 is on counter1' (measured) is suppressed, because it would contradict the map"
        in system.cli("check")
    )
    assert "note" not in system.cli("list", "--on", "Counter", "--format", "json")


def test_a_dry_run_tells_the_notes_of_the_tbox_that_is_tried(system, tmp_path):
    lab = tmp_path / "more.ttl"
    axiom = "dm:Milk rdfs:subClassOf [ a owl:Restriction ; owl:onProperty dm:isOn ; owl:minCardinality 3 ] ."
    lab.write_text(HOUSEHOLD_TTL.read_text() + axiom)
    tried = system.cli("load", str(lab), "--tbox", "--dry-run")
    told = system.cli("load", str(lab), "--tbox")
    assert notes(told) == notes(tried)
    assert notes(told)


def notes(text):
    return [line for line in text.splitlines() if line.startswith("note: ")]
