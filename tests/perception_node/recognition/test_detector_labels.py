"""Labels of a detector combined with our votes."""

from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest

from semmap.nodes.perception_node.recognition.detector_labels import (
    LabelMap,
    as_general,
    detector_class,
    unknown_label,
    with_detector_labels,
)
from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN
from semmap.schemas.entities import ClassInfo

LEARNT = SimpleNamespace(
    classes=("Fork", "Spoon", "Book", UNKNOWN, CLUTTER),
    ancestors={"Fork": ("Cutlery",), "Spoon": ("Cutlery",), "Cutlery": ("Object",)},
)
LABELS = LabelMap(LEARNT, {"dining-fork": "Fork", "teapot": "Tea_Pot", "reading matter": "Book"})
CHANCES = np.array([[0.2, 0.1, 0.3, 0.1, 0.3]])


class Said(NamedTuple):
    """The label of a detector for a mask."""

    label: str
    score: float


def said(label, score=0.9):
    return Said(label, score)


def thing(*told, masked=True):
    return SimpleNamespace(masked=masked, segments=[SimpleNamespace(detector_label=one) for one in told])


def named(*told, masked=True):
    return with_detector_labels(CHANCES, [thing(*told, masked=masked)], LEARNT, LABELS)[0]


@pytest.mark.parametrize(
    ("label", "class_"),
    [
        ("Fork", "Fork"),
        ("FORK", "Fork"),
        ("dining_fork", "Fork"),
        ("Dining Fork", "Fork"),
        ("cutlery", "Cutlery"),
        ("Tea-Pot", "Tea_Pot"),
        ("readingmatter", "Book"),
        ("saucer", None),
        ("", None),
    ],
)
def test_a_label_is_a_class_whatever_its_case_and_spaces(label, class_):
    assert LABELS.class_of(label) == class_


def test_a_label_of_one_s_own_comes_before_a_class_of_that_name():
    assert LabelMap(LEARNT, {"fork": "Garden_Fork"}).class_of("Fork") == "Garden_Fork"
    assert LabelMap(LEARNT).class_of("Fork") == "Fork"


def test_learnt_is_what_our_votes_know_by_exactly_this_name():
    assert LABELS.is_learnt("Fork")
    assert LABELS.is_learnt("Cutlery")
    assert not LABELS.is_learnt("fork")
    assert not LABELS.is_learnt("Tea_Pot")


def test_labels_that_nobody_knows_are_named_once():
    masks = [SimpleNamespace(detector_labels=[said("saucer"), said("fork"), None]), None]
    masks.append(SimpleNamespace(detector_labels=[said("saucer"), said("ladle")]))
    assert LABELS.unknown(masks) == ("ladle", "saucer")


def test_what_no_detector_masked_stays_as_it_is():
    assert named(said("Fork"), masked=False) == pytest.approx(CHANCES[0])


def test_what_a_detector_masked_is_no_clutter():
    assert named() == pytest.approx([0.2, 0.1, 0.3, 0.4, 0.0])
    assert named(None, said("saucer")) == pytest.approx([0.2, 0.1, 0.3, 0.4, 0.0])
    assert CHANCES.tolist() == [[0.2, 0.1, 0.3, 0.1, 0.3]]  # which is not written to


def test_a_label_is_evidence_for_its_leaves_by_its_score():
    votes = np.sqrt([0.2, 0.1, 0.3, 0.4, 1e-4])
    weights = np.array([0.9, *[0.1 / 4] * 4])
    expected = votes * weights
    expected[4] = 0.0
    assert named(said("Fork")) == pytest.approx(expected / expected.sum())


def test_a_label_of_a_class_above_is_evidence_for_all_its_leaves():
    votes = np.sqrt([0.2, 0.1, 0.3, 0.4, 1e-4])
    expected = votes * [0.45, 0.45, *[0.1 / 3] * 3]
    expected[4] = 0.0
    assert named(said("Cutlery")) == pytest.approx(expected / expected.sum())


def test_no_score_is_beyond_all_doubt_and_no_vote_rules_a_class_out():
    sure = named(said("Fork", 1.0))
    assert sure == pytest.approx(named(said("Fork", 0.98)))
    assert 0.0 < sure[2] < 0.1
    none = with_detector_labels(
        np.array([[0.0, 0.0, 1.0, 0.0, 0.0]]), [thing(said("Fork", 0.98))], LEARNT, LABELS
    )[0]
    by_hand = np.array([0.01 * 0.98, 0.01 * 0.005, 1.0 * 0.005, 0.01 * 0.005, 0.0])
    assert none == pytest.approx(by_hand / by_hand.sum())


def test_what_is_said_of_two_views_counts_twice_only_where_it_differs():
    once = named(said("Fork", 0.7))
    one = said("Fork", 0.7)
    twice = with_detector_labels(
        CHANCES, [SimpleNamespace(masked=True, segments=_segments(one, one))], LEARNT, LABELS
    )
    assert twice[0] == pytest.approx(once)


def _segments(*told):
    return [SimpleNamespace(detector_label=one) for one in told]


def test_a_class_that_was_never_learnt_is_told_by_the_surest_detector():
    told = thing(said("teapot", 0.4), said("fork", 0.9), None, said("TeaPot", 0.6), said("saucer", 0.99))
    assert detector_class(told, LEARNT, LABELS) == ("Tea_Pot", 0.6)
    assert detector_class(thing(said("fork")), LEARNT, LABELS) is None
    assert detector_class(thing(), LEARNT, LABELS) is None


def test_a_label_of_no_class_is_kept_in_one_line():
    told = thing(said("saucer", 0.4), said("fork", 0.9), None, said(" power\n drill ", 0.6))
    assert unknown_label(told, LABELS) == "power drill"
    assert unknown_label(thing(said("fork")), LABELS) == ""
    assert unknown_label(thing(said("fork"), said("7", 0.9)), LABELS) == ""
    assert unknown_label(thing(said("7", 0.9), said(" "), None), LABELS) is None
    assert unknown_label(thing(None), LABELS) is None
    assert len(unknown_label(thing(said("x" * 5000)), LABELS)) == 100


def own_class(name, *ancestors, label="", spatial=True):
    """Return a class of a TBox of one's own."""
    return ClassInfo(
        name=name,
        iri=f"urn:{name}",
        parents=ancestors[:1],
        ancestors=ancestors,
        labels={"en": label} if label else {},
        spatial=spatial,
        place=False,
        fixed=False,
        model="",
    )


OWN = LabelMap(
    LEARNT,
    tbox=[
        own_class("PastaFork", "Fork", "Cutlery", "Object", label="spaghetti fork"),
        own_class("PowerDrill", "Object", label="Power drill"),
        own_class("Drilling", label="drilling", spatial=False),
    ],
)


def test_classes_of_the_tbox_are_known_by_name_and_label():
    names = ("power drill", "PowerDrill", "Spaghetti Fork", "fork", "drilling")
    assert [OWN.class_of(name) for name in names] == ["PowerDrill", "PowerDrill", "PastaFork", "Fork", None]


def test_a_class_of_one_s_own_is_evidence_for_the_class_above_it():
    forks = with_detector_labels(CHANCES, [thing(said("Fork"))], LEARNT, OWN)
    own = with_detector_labels(CHANCES, [thing(said("spaghetti fork"))], LEARNT, OWN)
    assert own[0] == pytest.approx(forks[0])
    drill = with_detector_labels(CHANCES, [thing(said("power drill"))], LEARNT, OWN)
    assert drill[0] == pytest.approx(with_detector_labels(CHANCES, [thing()], LEARNT, OWN)[0])


def test_a_class_of_the_taxonomy_without_models_is_evidence_for_the_class_above_it_without_a_tbox():
    ancestors = {**LEARNT.ancestors, "Dessert_Fork": ("Fork", "Cutlery", "Object")}
    learnt = SimpleNamespace(classes=LEARNT.classes, ancestors=ancestors)
    labels = LabelMap(learnt)
    one = thing(said("dessert fork"))
    assert with_detector_labels(CHANCES, [one], learnt, labels)[0] == pytest.approx(named(said("Fork")))
    assert labels.ancestors_of("Dessert_Fork") == ("Fork", "Cutlery", "Object")


def test_common_labels_name_classes_that_are_known():
    learnt = SimpleNamespace(classes=("Cup", UNKNOWN, CLUTTER), ancestors={"Cup": ("Object",)})
    assert LabelMap(learnt).class_of("coffee mug") == "Cup"
    assert LabelMap(learnt).class_of("refrigerator") is None


@pytest.mark.parametrize(
    ("label", "fork", "class_"),
    [
        ("cutlery", 0.6, "Cutlery"),  # our vote for a fork is not strong
        ("cutlery", 0.8, "Fork"),
        ("fork", 0.1, "Fork"),
        ("object", 0.1, "Fork"),  # which says nothing
        ("book", 0.1, "Fork"),
        ("saucer", 0.1, "Fork"),
    ],
)
def test_a_general_label_stays_general_without_strong_votes_below_it(label, fork, class_):
    own = {"Fork": fork, "Spoon": 0.0, "Book": 1.0 - fork, UNKNOWN: 0.0, CLUTTER: 0.0}
    assert as_general(thing(said(label)), "Fork", own, LEARNT, LABELS) == class_
