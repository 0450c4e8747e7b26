"""The triples that queries read: asserted, inferred, suppressed and measured."""

from __future__ import annotations

import pytest

from semmap.nodes.kb_node.sparql.triples.dataset import (
    ASSERTED,
    DENIED,
    INFERRED,
    MEASURED,
    Dataset,
    Delta,
    DiskDataset,
    as_stored,
)
from semmap.ontology import vocabulary as v
from tests.kb_node.home import turtle

(ON,) = turtle(":cup1 dm:isOn :table1 .")
(NEAR,) = turtle(":cup1 dm:isNear :table1 .")
CUP, TABLE = ON[0], ON[2]
MASS = {
    text: (CUP, v.dm("mass"), f'"{text}"^^{v.iri(v.XSD + "decimal")}') for text in ("2.5", "2.50", "2.500")
}


def graph(dataset, name):
    return {str(quad.predicate.value) for quad in dataset.store.quads_for_pattern(None, None, None, name)}


def local(dataset, name):
    return {iri.rpartition("#")[2] for iri in graph(dataset, name)}


@pytest.fixture
def dataset():
    return Dataset(7, [ON, *turtle(":cup1 a dm:Cup .")])


def test_a_commit_adds_and_removes_asserted_and_inferred_triples(dataset):
    dataset.apply(Delta(seq=8, retracted=(ON,), inserted=(NEAR,), newly_inferred=(ON,)))
    assert dataset.seq == 8
    assert local(dataset, ASSERTED) == {"isNear", "type"}
    assert local(dataset, INFERRED) == {"isOn"}
    dataset.apply(Delta(seq=9, no_longer_inferred=(ON,)))
    assert local(dataset, INFERRED) == set()


def test_a_suppressed_assertion_is_in_another_graph(dataset):
    assert dataset.asserted_graphs() == [ASSERTED]
    dataset.apply(Delta(seq=8, denied=(ON,)))
    assert (local(dataset, ASSERTED), local(dataset, DENIED)) == ({"type"}, {"isOn"})
    assert (dataset.denials, dataset.asserted_graphs()) == (1, [ASSERTED, DENIED])
    dataset.apply(Delta(seq=9, undenied=(ON,)))
    assert (local(dataset, ASSERTED), local(dataset, DENIED)) == ({"isOn", "type"}, set())
    assert (dataset.denials, dataset.asserted_graphs()) == (0, [ASSERTED])


def test_what_is_no_longer_asserted_is_no_longer_suppressed(dataset):
    dataset.deny((ON,))
    dataset.apply(Delta(seq=8, undenied=(ON,), retracted=(ON,)))
    assert (local(dataset, ASSERTED), local(dataset, DENIED), dataset.denials) == ({"type"}, set(), 0)


def test_measured_relations_are_complete_from_their_request_on(dataset):
    dataset.apply(Delta(seq=8, measured=(NEAR,), demand=3))
    assert (local(dataset, MEASURED), dataset.demand) == ({"isNear"}, 3)
    assert dataset.is_measured(NEAR)
    assert not dataset.is_measured(ON)
    dataset.apply(Delta(seq=9, unmeasured=(NEAR,), demand=2))
    assert (local(dataset, MEASURED), dataset.demand) == (set(), 3)


def test_a_value_stays_until_its_last_spelling_is_retracted():
    for asserted, commits in (
        ([MASS["2.5"], MASS["2.50"]], []),
        ([MASS["2.5"]], [Delta(seq=8, inserted=(MASS["2.50"],))]),
    ):
        dataset = Dataset(7, asserted)
        for delta in commits:
            dataset.apply(delta)
        assert len(dataset.store) == 1
        dataset.apply(Delta(seq=9, retracted=(MASS["2.5"],)))
        assert local(dataset, ASSERTED) == {"mass"}
        dataset.apply(Delta(seq=10, inserted=(MASS["2.500"],)))
        dataset.apply(Delta(seq=11, retracted=(MASS["2.50"],)))
        assert local(dataset, ASSERTED) == {"mass"}
        dataset.apply(Delta(seq=12, retracted=(MASS["2.500"],)))
        assert local(dataset, ASSERTED) == set()


def test_a_relation_is_found_in_its_graph(dataset):
    dataset.infer([NEAR])
    assert dataset.follows(NEAR)
    assert not dataset.follows(ON)
    assert dataset.holds_unmeasured(ON)
    assert dataset.holds_unmeasured(NEAR)
    assert not dataset.holds_unmeasured(turtle(":table1 dm:isOn :cup1 .")[0])
    assert dataset.inferred(CUP) == dataset.inferred(None) == {NEAR}
    assert dataset.inferred(TABLE) == set()


def test_neighbours_are_related_in_either_direction(dataset):
    dataset.infer(turtle(":box1 dm:isIn :cup1 . :cup1 dm:mass 2 ."))
    assert dataset.neighbours(CUP) == {TABLE, v.entity_iri("box1")}
    assert dataset.neighbours(TABLE) == {CUP}
    assert dataset.neighbours(v.dm("Cup")) == set()


def test_a_blank_node_is_a_subject_like_others():
    triple = ("_:b1", v.dm("isOn"), "_:b2")
    dataset = Dataset(1, [triple])
    assert dataset.holds_unmeasured(triple)
    assert dataset.neighbours("_:b2") == {"_:b1"}


@pytest.mark.parametrize(
    ("term", "stored"),
    [
        (MASS["2.50"][2], MASS["2.5"][2]),
        ('"2.50"', '"2.50"'),
        (CUP, CUP),
        ('"a"@en', '"a"@en'),
    ],
)
def test_a_number_is_written_as_the_store_does(term, stored):
    assert as_stored(term) == stored


def test_the_parts_of_a_commit():
    delta = Delta(seq=1, retracted=(ON,), inserted=(NEAR,), denied=(MASS["2.5"],), measured=(MASS["2.50"],))
    assert delta.asserted == (ON, NEAR)
    assert delta.everything == (ON, NEAR, MASS["2.5"], MASS["2.50"])
    rest = Delta(
        seq=1, no_longer_inferred=(ON,), newly_inferred=(NEAR,), undenied=(MASS["2.5"],), unmeasured=(ON,)
    )
    assert rest.everything == (ON, NEAR, MASS["2.5"], ON)


def test_a_dataset_on_disk_only_notes_the_number_of_a_commit(tmp_path):
    dataset = DiskDataset(tmp_path, 3, 5)
    dataset.apply(Delta(seq=4, inserted=(ON,)))
    assert (dataset.seq, dataset.settled, len(dataset.store)) == (4, 5, 0)
