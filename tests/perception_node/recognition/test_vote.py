from types import SimpleNamespace

import numpy as np
import pytest

from semmap.nodes.perception_node.recognition.features import SORTS
from semmap.nodes.perception_node.recognition.perceptron import Perceptron, log_softmax
from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN, VOTERS
from semmap.nodes.perception_node.recognition.vote import (
    choose_class,
    expected_sizes,
    leaf_probabilities,
    log_votes,
    pool_votes,
    vote,
    voter_inputs,
)

ABOVE = {
    "Fork": ("Cutlery", "Tableware", "Object"),
    "Spoon": ("Cutlery", "Tableware", "Object"),
    "Plate": ("Tableware", "Object"),
    "Book": ("Object",),
    "Magazine": ("Book", "Object"),
}


@pytest.mark.parametrize(
    ("leaves", "said", "probability"),
    [
        ({"Fork": 0.9, "Spoon": 0.1}, "Fork", 0.9),
        ({"Fork": 0.5, "Spoon": 0.4, "Book": 0.1}, "Cutlery", 0.9),
        ({"Fork": 0.3, "Spoon": 0.2, "Plate": 0.3, "Book": 0.2}, "Tableware", 0.8),
        ({"Magazine": 0.45, "Book": 0.4, "Fork": 0.15}, "Book", 0.85),
        ({"Fork": 0.65, "Spoon": 0.35}, "Cutlery", 1.0),
        ({"Fork": 0.3, "Book": 0.3, "Object": 0.4}, "Object", 1.0),
        ({"Fork": 0.2, "Object": 0.8}, "Object", 1.0),
        ({"Fork": 0.3, UNKNOWN: 0.7}, UNKNOWN, 1.0),
        ({"Fork": 0.3, CLUTTER: 0.7}, UNKNOWN, 0.3),
        ({"Fork": 0.6, UNKNOWN: 0.4}, "Fork", 0.6),
        ({"Fork": 1.1}, "Fork", 1.0),
    ],
)
def test_the_most_special_class_that_is_sure_enough(leaves, said, probability):
    class_, sure = choose_class(leaves, ABOVE, 0.6)
    assert (class_, sure) == (said, pytest.approx(probability))


def test_of_two_that_are_sure_the_likelier():
    assert choose_class({"Fork": 0.5, "Book": 0.5}, ABOVE, 0.5)[0] in ("Fork", "Book")
    assert choose_class({"Fork": 0.45, "Book": 0.55}, ABOVE, 0.4)[0] == "Book"


def test_a_class_must_have_most_of_what_each_above_it_has():
    assert choose_class({"Fork": 0.91, "Plate": 0.09}, ABOVE)[0] == "Fork"
    assert choose_class({"Fork": 0.89, "Plate": 0.11}, ABOVE)[0] == "Tableware"
    assert choose_class({"Fork": 0.89, "Plate": 0.11}, ABOVE, clear=0.8)[0] == "Fork"


WIDTHS = dict(zip(SORTS, range(1, len(SORTS) + 1), strict=True))
RNG = np.random.default_rng(0)
FEATURES = [RNG.normal(size=(3, width)) for width in WIDTHS.values()]
CLASSES = ("Fork", "Plate", UNKNOWN, CLUTTER)


def linear(inputs, outputs=4):
    return Perceptron(
        np.zeros(inputs), np.ones(inputs), (RNG.normal(size=(inputs, outputs)),), (np.zeros(outputs),)
    )


VOTING = [linear(sum(WIDTHS[sort] for sort in sorts)) for sorts in VOTERS.values()]
WEIGHTS = np.linspace(0.2, 1.0, len(VOTING))


def test_each_voter_sees_the_sorts_of_features_that_it_knows():
    of_sort = dict(zip(SORTS, FEATURES, strict=True))
    for shown, sorts in zip(voter_inputs(FEATURES), VOTERS.values(), strict=True):
        assert (shown == np.concatenate([of_sort[sort] for sort in sorts], axis=1)).all()


def test_the_logarithms_of_votes_add_up_by_their_weights():
    votes = log_votes(VOTING, FEATURES)
    assert votes.shape == (len(VOTING), 3, 4)
    assert np.exp(votes).sum(axis=2) == pytest.approx(1.0)
    by_hand = log_softmax(sum(weight * own for weight, own in zip(WEIGHTS, votes, strict=True)))
    assert pool_votes(votes, WEIGHTS) == pytest.approx(by_hand)
    assert vote(VOTING, WEIGHTS, FEATURES) == pytest.approx(np.exp(by_hand))


def learnt(new=0.0, familiar=None, shown=None):
    """Return a model in which all things are new with this probability; `familiar` are its form scores."""
    scores = np.array([[-50.0] * 4 + [50.0]] if familiar is None else [familiar])
    return SimpleNamespace(
        voters=VOTING,
        weights=WEIGHTS,
        classes=CLASSES,
        novelty=lambda features, votes, pooled: np.full(len(pooled), new),
        familiar=lambda features: np.repeat(scores, len(features), axis=0),
        exemplars=shown,
    )


def test_without_models_of_ours_leaves_are_what_the_votes_say():
    assert leaf_probabilities(learnt(), FEATURES) == pytest.approx(vote(VOTING, WEIGHTS, FEATURES), abs=1e-6)


def test_what_is_new_is_unknown_and_clutter_stays_clutter():
    plain, found = vote(VOTING, WEIGHTS, FEATURES), leaf_probabilities(learnt(new=0.25), FEATURES)
    assert found[:, :2] == pytest.approx(0.75 * plain[:, :2], abs=1e-6)
    assert found[:, 2] == pytest.approx(plain[:, 2] + 0.25 * plain[:, :2].sum(axis=1), abs=1e-6)
    assert found[:, 3] == pytest.approx(plain[:, 3], abs=1e-6)


def test_what_has_the_form_of_a_model_of_ours_is_that_whatever_votes_say():
    found = leaf_probabilities(learnt(familiar=[-50.0, 50.0, -50.0, -50.0, -50.0]), FEATURES)
    assert found[:, 1] == pytest.approx(1.0, abs=1e-6)


def test_what_votes_rule_out_a_form_is_less_likely():
    plain = np.log(vote(VOTING, WEIGHTS, FEATURES))
    found = leaf_probabilities(learnt(familiar=[5.0, 5.0, -50.0, -50.0, -50.0]), FEATURES)
    assert np.log(found[:, 0] / found[:, 1]) == pytest.approx(0.2 * (plain[:, 0] - plain[:, 1]))


def test_exemplars_add_their_probabilities():
    shown = SimpleNamespace(add_probabilities=lambda features, chances: (features, chances))
    features, chances = leaf_probabilities(learnt(shown=shown), FEATURES)
    assert features is FEATURES
    assert chances == pytest.approx(vote(VOTING, WEIGHTS, FEATURES), abs=1e-6)


def test_the_size_that_is_expected_is_the_geometric_mean_of_those_of_the_leaves():
    sizes_m = np.array([(0.1, 0.2, 0.4), (0.4, 0.2, 0.1)])
    assert expected_sizes(np.array([[0.5, 0.5], [1.0, 0.0]]), sizes_m) == pytest.approx(
        np.array([(0.2, 0.2, 0.2), (0.1, 0.2, 0.4)])
    )
