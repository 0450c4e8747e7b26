"""All relations in a kitchen: the measured values, the reports, and why relations hold or do not.

Each line of a file in `scene/` is about one pair of things. Lengths in metres, relations from the pose in
`VIEWPOINT` included.
"""

from itertools import permutations
from pathlib import Path

import pytest

from semmap.nodes.kb_node.relations.measuring import containment, overhead, places, proximity, support_contact
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.relation_reports import explain_relation, list_relations
from semmap.schemas.commands import Relations
from tests.kb_node.relations.kitchen import THINGS

FOLDER = Path(__file__).parent / "scene"
VIEWPOINT = (-2.5, -1.0, 1.5, 0.3)
MEASURES = (
    *(support_contact.on, support_contact.over, containment.inside, proximity.touches, places.within),
    *(proximity.against, overhead.beneath),
)
EXPLAINED = (
    *("isOn", "isInside", "isAttachedTo", "isLeaningAgainst", "isUnder", "isNextTo", "isLeftOf", "isBehind"),
    *("isLocatedIn", "touches"),
)
MOST_EXPLAINED_M = 0.1
PLACES = ("kitchen1", "corner1")


@pytest.fixture(scope="module")
def kitchen():
    return Space(THINGS)


def lines(name):
    return (FOLDER / f"{name}.txt").read_text().splitlines()


def measure_all(kitchen):
    """Yield what each function measures of each pair; a relation to the whole kitchen says little."""
    for one, other in permutations(kitchen.solids.values(), 2):
        if "kitchen1" in (one.name, other.name):
            continue
        for measure in MEASURES:
            made = measure(one, other, kitchen.limits)
            if made is not None:
                yield f"{one.name} {measure.__name__} {other.name}: {show(made)}"
        if one.name < other.name and (apart := proximity.gap(one, other)) < 0.5:
            near = proximity.near(one, other, kitchen.limits)
            limit = (
                "" if near is None else f", {'near' if near.holds else 'not near'} up to {number(near.limit)}"
            )
            yield f"{one.name} and {other.name} are {number(apart)} apart{limit}"


def number(value):
    return f"{round(value, 4) + 0.0:g}"


def show(made):
    base = " of the base" if made.by_base else ""
    share = f"share {number(made.share)}{base}, height {number(made.height_m)}, limit {number(made.limit)}"
    return f"{'yes' if made.holds else 'no'}, gap {number(made.gap_m)}, {share}"


def report_all(kitchen):
    for name in kitchen.solids:
        if name not in PLACES:
            yield from (
                made.text for made in list_relations(kitchen, Relations(name=name, viewpoint=VIEWPOINT))
            )


def explain_all(kitchen):
    for one, other in permutations(kitchen.solids.values(), 2):
        if one.name not in PLACES and proximity.gap(one, other) <= MOST_EXPLAINED_M:
            for relation in EXPLAINED if other.name not in PLACES else ("isLocatedIn",):
                yield explain_relation(kitchen, one.name, relation, other.name).text


def test_what_is_measured_of_each_pair(kitchen):
    assert list(measure_all(kitchen)) == lines("measures")


def test_what_is_reported_of_each_thing(kitchen):
    assert list(report_all(kitchen)) == lines("reports")


def test_why_relations_hold_or_do_not(kitchen):
    assert list(explain_all(kitchen)) == lines("explanations")


def test_whatever_may_be_inside_is_found_by_the_fast_check(kitchen):
    for one, other in permutations(kitchen.solids.values(), 2):
        made = containment.inside(one, other, kitchen.limits)
        if made is not None and made.holds:
            assert containment.may_be_inside(one, other, kitchen.limits), (one.name, other.name)
