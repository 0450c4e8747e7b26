import numpy as np
import pytest

from semmap.nodes.perception_node.recognition.features import SORTS
from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN, load, save, shipped
from semmap.nodes.perception_node.recognition.vote import leaf_probabilities
from semmap.schemas.errors import BadFile


def random_features(learnt, count=5):
    rng = np.random.default_rng(0)
    return [
        voter.mean + voter.scale * rng.normal(size=(count, len(voter.mean)))
        for voter in learnt.voters[: len(SORTS)]
    ]


def test_what_ships_says_what_it_was_learnt_from():
    learnt = shipped()
    assert "model library" in learnt.story
    assert {UNKNOWN, CLUTTER, "Apple", "Table"} <= set(learnt.classes)
    assert learnt.ancestors["Apple"] == ("Fruit", "Food", "Object")


def test_a_file_gives_back_what_was_saved(tmp_path):
    learnt = shipped()
    save(learnt, tmp_path / "copy.npz")
    again = load(tmp_path / "copy.npz")
    seen = random_features(learnt)
    assert leaf_probabilities(again, seen) == pytest.approx(leaf_probabilities(learnt, seen), abs=1e-6)
    assert again.story == learnt.story


def test_probabilities_add_up():
    chances = leaf_probabilities(shipped(), random_features(shipped(), 20))
    assert chances.sum(axis=1) == pytest.approx(1.0)
    assert (chances >= 0.0).all()


def test_what_is_far_from_all_that_was_learnt_is_unknown():
    learnt = shipped()
    far = [voter.mean + 40.0 * voter.scale for voter in learnt.voters[: len(SORTS)]]
    chances = leaf_probabilities(learnt, [f[None] for f in far])
    assert chances[0, learnt.classes.index(UNKNOWN)] + chances[0, learnt.classes.index(CLUTTER)] > 0.5


@pytest.mark.parametrize("content", [b"", b"no archive"])
def test_another_file_is_told(tmp_path, content):
    path = tmp_path / "learnt.npz"
    path.write_bytes(content)
    with pytest.raises(BadFile, match="is not a valid recognition model"):
        load(path)
