"""The counts of the benchmark of spatial relations, on a few scenes."""

import pytest

from benchmarks.relations.accuracy import Counts, against_contacts, flat, inside_against_samples
from benchmarks.relations.speed import rooms
from benchmarks.relations.stability import at_rest
from benchmarks.table import Row, as_json
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.relations.facts.contradictions import PROPERTIES, fact_of
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.ontology import FLAT_TTL
from tests.benchmarks.noisy_looks import gone


def test_shares_of_right_ones():
    some = Counts.of({("a", "b"), ("c", "d")}, {("a", "b"), ("e", "f"), ("g", "h")})
    assert some == Counts(right=1, extra=1, missing=2)
    assert some.f1 == 0.4
    assert Counts.together([some, some]) == Counts(2, 2, 4)


@pytest.mark.long
def test_settled_heaps_and_sampled_points():
    on, touches, _ = against_contacts(4)
    assert on.right > 20
    assert on.f1 > 0.95
    assert touches.f1 > 0.95
    assert inside_against_samples(200).f1 > 0.9


def test_the_flat_is_as_it_was_described():
    found = flat()
    assert found.said == 58
    assert not found.missing
    assert not found.extra


def test_things_at_rest_under_noisy_eyes_keep_their_relations():
    went, hold = gone(seconds=30.0)
    assert went == 0
    assert hold > 35


def test_the_flat_says_itself_only_what_is_not_computed():
    """Whatever is computed need not be said by hand, and would be there twice."""
    said = [t for t in rdf.parse(FLAT_TTL.read_bytes(), "flat", label_prefix="f") if t[1] in PROPERTIES]
    assert sorted(map(fact_of, said)) == flat().missing


def test_the_rooms_are_of_tables_with_cups_on_them():
    facts = Facts()
    facts.update(there := rooms(100))
    assert len(there) == 100
    assert {relation for _, relation, _ in facts} == {"isOn", "isLocatedIn"}
    assert sum(relation == "isOn" for _, relation, _ in facts) == 84


def test_a_row_says_which_way_is_better():
    assert as_json(Row("F1", 0.9, "", 0.8, 0.9, more=True))["better"] == "higher"
    assert as_json(Row("move", 0.9, "ms", 1.0, 0.5))["better"] == "lower"


@pytest.mark.long
def test_things_at_rest_are_watched():
    """One second of cameras and perception: enough to know what stands on the table."""
    found = at_rest(0.2, things=6)
    assert (found.things, found.on_the_table, found.changes) == (6, 6, 0)
