import numpy as np
import pytest

from semmap.nodes.perception_node.recognition.features import SORTS
from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN, VOTERS
from semmap.nodes.perception_node.recognition.vote import log_votes, pool_votes, voter_inputs
from semmap.nodes.training.recognition.fitting import classifier
from semmap.nodes.training.recognition.gradient_descent import Recipe
from semmap.nodes.training.recognition.learn_open_set import LabelledSamples, learn_novelty

CLASSES = (CLUTTER, UNKNOWN, *(f"Class{n}" for n in range(38)))
UNKNOWN_AT = CLASSES.index(UNKNOWN)
WIDTH, EACH = 48, 60
RECIPES = (Recipe((16,), batch=16, rate=1e-2),) * len(VOTERS)
rng = np.random.default_rng(0)
CENTRES = rng.normal(0.0, 2.0, (len(CLASSES), WIDTH))


def sorts(features):
    return np.array_split(features, len(SORTS), axis=1)


def between(count):
    """Things half like one class and half like another, that are of neither."""
    pairs = rng.integers(2, len(CLASSES), (count, 2))
    return CENTRES[pairs].mean(axis=1) + rng.normal(0.0, 0.5, (count, WIDTH)), np.full(count, UNKNOWN_AT)


@pytest.mark.long
def test_what_is_unlike_all_that_was_learnt_is_doubted():
    target = np.repeat(np.arange(len(CLASSES)), EACH)
    own = CENTRES[target] + rng.normal(0.0, 0.5, (len(target), WIDTH))
    odd, named = between(800)
    features = sorts(np.concatenate([own, odd]))
    stranger = np.concatenate([np.full(len(target), -1), np.arange(len(odd)) % 8])
    target = np.concatenate([target, named])
    held = np.arange(len(target)) % 5 == 0
    labelled = LabelledSamples(features, target, stranger, held, CLASSES, {})
    weights = np.full(len(VOTERS), 1.0 / len(VOTERS))  # as calibration has it, nearly
    novelty = learn_novelty(labelled, RECIPES, weights)
    shown = voter_inputs(labelled.of(~held & (stranger < 0)))
    voters = [
        classifier(seen, target[~held & (stranger < 0)], len(CLASSES), recipe)
        for seen, recipe in zip(shown, RECIPES, strict=True)
    ]

    def doubt(things):
        votes = log_votes(voters, sorts(things))
        return novelty(sorts(things), votes, pool_votes(votes, weights))

    known = CENTRES[2:] + rng.normal(0.0, 0.5, (len(CLASSES) - 2, WIDTH))
    odder = doubt(between(100)[0])[:, None] > doubt(known)
    assert np.median(doubt(known)) < 0.1
    assert odder.mean() > 0.85
