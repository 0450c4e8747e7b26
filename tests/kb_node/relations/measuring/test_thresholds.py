"""Thresholds are annotations of the TBox."""

import pytest

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.measuring.thresholds import ANNOTATIONS, Thresholds, read_thresholds
from semmap.ontology import HOUSEHOLD_TTL
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from tests.kb_node.relations.entities import TABLE, TOP, thing


def said(**values):
    """Return a TBox with these annotations, such as isOn_greatestGap="0.01"."""
    triples = {tuple(key.split("_")): v.literal(text, v.XSD_FLOAT) for key, text in values.items()}
    names = {(v.dm(p), v.dm(a)): value for (p, a), value in triples.items()}
    return read_thresholds(lambda p, a: [names[p, a]] if (p, a) in names else [])


def test_the_household_tbox_states_the_defaults():
    triples = rdf.parse(HOUSEHOLD_TTL.read_bytes(), HOUSEHOLD_TTL.name)
    about = [(v.dm(a.property), v.dm(a.annotation)) for a in ANNOTATIONS]
    assert all(any((s, p) == one for s, p, _ in triples) for one in about)
    assert read_thresholds(lambda s, p: [o for a, b, o in triples if (a, b) == (s, p)]) == Thresholds()
    assert read_thresholds(lambda s, p: ()) == Thresholds()


def test_a_tbox_can_change_a_threshold():
    cup = thing("cup1", (0.0, 0.0, TOP + 0.03))
    for limits, on in ((said(), True), (said(isOn_greatestGap="0.02"), False)):
        facts = Facts(limits)
        facts.update([TABLE, cup])
        assert (("cup1", "isOn", "table1") in facts) == on


@pytest.mark.parametrize("text", ["-0.1", "1.5", "nan", "wide"])
def test_an_invalid_threshold_is_rejected(text):
    with pytest.raises(errors.BadRequest, match="invalid leastShare of isInside"):
        said(isInside_leastShare=text)


def test_each_threshold_has_a_greatest_value():
    most = {
        "isOn_steepestNormal": 89.0,
        "isNear_greatestGap": 100.0,
        "isNear_greatestGapToSize": 100.0,
        "isLeaningAgainst_leastTilt": 45.0,
    }
    for about in ANNOTATIONS:
        name = f"{about.property}_{about.annotation}"
        value = most.get(name, 1.0)
        assert getattr(said(**{name: f"{value}"}), about.field) == value
        with pytest.raises(errors.BadRequest, match=f"use a number from 0 to {value:g}"):
            said(**{name: f"{value + 0.01}"})
