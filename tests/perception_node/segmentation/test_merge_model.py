"""The file of the merge model."""

import json

import numpy as np
import pytest

from semmap.nodes.perception_node.segmentation import merge_model
from semmap.nodes.perception_node.segmentation.merge_model import MergeModel, load, save
from semmap.nodes.perception_node.segmentation.pairs import NAMES
from semmap.nodes.perception_node.segmentation.trees import LEAVES, Trees
from semmap.schemas.errors import BadFile

STUMP = Trees(
    feature=np.array([1], np.int32),
    threshold=np.array([0.5], np.float32),
    keeps=np.array([0b10], np.uint16),
    first=np.array([0], np.int32),
    value=np.arange(LEAVES, dtype=np.float32)[None],
    bias=0.25,
)


def test_a_stored_model_is_read_back(tmp_path):
    path = tmp_path / "merge.npz"
    save(MergeModel(STUMP, "two scenes"), path)
    found = load(path)
    assert found.story == "two scenes"
    assert found.trees.bias == 0.25
    for name in ("feature", "threshold", "keeps", "first", "value"):
        kept, given = getattr(found.trees, name), getattr(STUMP, name)
        assert kept.dtype == given.dtype
        assert kept.tolist() == given.tolist()
    rows = np.array([[0.0, 0.4], [0.0, 0.6]], np.float32)
    assert found.trees.probability(rows) == pytest.approx(STUMP.probability(rows))


def test_a_model_of_other_features_names_the_command_that_makes_a_new_one(tmp_path, monkeypatch):
    path = tmp_path / "merge.npz"
    monkeypatch.setattr(merge_model, "NAMES", ("another", *NAMES))
    save(MergeModel(STUMP, ""), path)
    monkeypatch.undo()
    with pytest.raises(BadFile, match="it uses other features; run: make train-perception"):
        load(path)


@pytest.mark.parametrize("content", [b"", b"PK", b"not an archive"])
def test_an_invalid_file_is_named(tmp_path, content):
    path = tmp_path / "merge.npz"
    path.write_bytes(content)
    with pytest.raises(BadFile, match=r"merge\.npz is not a valid merge model"):
        load(path)


def test_a_file_without_one_of_the_arrays_is_invalid(tmp_path):
    path = tmp_path / "merge.npz"
    np.savez_compressed(path, description=np.array(json.dumps({"story": "", "bias": 0, "features": NAMES})))
    with pytest.raises(BadFile, match="not a valid merge model"):
        load(path)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(BadFile, match=r"nothing\.npz is not a valid merge model"):
        load(tmp_path / "nothing.npz")
