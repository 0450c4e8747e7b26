"""The truth of small drawn worlds, and its comparison with relations that are wrong on purpose."""

import hashlib

import pytest

from benchmarks.relations import foreign
from benchmarks.relations.foreign import comparison
from benchmarks.relations.foreign.drawing import (
    Body,
    ForeignWorld,
    ball,
    box,
    crate,
    fixed,
    free,
    table,
    tube,
)
from benchmarks.relations.foreign.settling import settle
from benchmarks.relations.foreign.truth import find_truth
from tests.household import household_classes

FIRST_DIGEST = "46eda941af11b494"
SMALL = ForeignWorld(
    "small",
    (
        fixed("table_1", (0, 0, 0), table(1.0, 0.8, 0.7)),
        free("tray_crate", (0, 0, 0.7), crate((0.3, 0.3, 0.1))),
        free("orange", (0, 0, 0.71), ball(0.035)),
        free("pole", (0.1, 0.1, 0.711), tube(0.01, 0.4)),
        free("block", (0.35, 0, 0.7), box((0.1, 0.1, 0.1))),
        free("block_top", (0.37, 0, 0.8), box((0.1, 0.1, 0.1))),
        free(
            "stool", (0, 0.1, 0), box((0.3, 0.3, 0.4)), Body("stool_foot", (0, 0, 0), box((0.31, 0.31, 0.02)))
        ),
    ),
)


@pytest.fixture(scope="module")
def rest():
    return settle(SMALL)


def test_forces_and_samples_give_the_relations_that_a_person_would_state(rest):
    on, inside, under = ({pair for pair, is_ in some.items() if is_} for some in find_truth(rest))
    assert rest.is_calm
    assert on == {("tray_crate", "table_1"), ("block", "table_1"), ("block_top", "block")}
    assert inside == {("orange", "tray_crate"), ("pole", "tray_crate")}
    assert under >= {("stool", "table_1"), ("stool", "orange")}
    assert ("block", "block_top") not in under


def test_wrong_and_missing_relations_are_errors(monkeypatch):
    on = {("tray_crate", "table_1"), ("block", "table_1"), ("block", "stool")}
    monkeypatch.setattr(comparison, "find_relations", lambda rest: (on, set(), {("stool", "table_1")}))
    compared = comparison.compare([SMALL])
    assert {str(error) for error in compared.errors} >= {
        "small: wrong: block isOn stool",
        "small: missing: block_top isOn block",
        "small: missing: orange isInside tray_crate",
    }
    assert compared.f1("isOn") == pytest.approx(4 / 6)
    assert comparison.Compared.together([compared, compared]).f1("isOn") == pytest.approx(4 / 6)


def test_relations_of_a_drawn_world(rest, monkeypatch):
    monkeypatch.setattr(comparison, "household_classes", household_classes)
    on, inside, under = comparison.find_relations(rest)
    assert on == {("tray_crate", "table_1"), ("block", "table_1"), ("block_top", "block")}
    assert inside == {("orange", "tray_crate"), ("pole", "tray_crate")}
    assert ("stool", "table_1") in under


def test_the_first_worlds_are_as_they_were_drawn():
    text = "".join(draw().text() for draw in foreign.FIRST)
    assert hashlib.sha256(text.encode()).hexdigest()[:16] == FIRST_DIGEST
    names = [draw().name for draw in (*foreign.FIRST, *foreign.LATER)]
    assert len(set(names)) == 35
