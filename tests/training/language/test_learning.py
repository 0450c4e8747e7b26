"""Training is reproducible, and the taggers recognise their training examples."""

import pytest

from benchmarks.language import trials
from benchmarks.language.scoring import scores
from semmap.nodes.language.understanding.interpretation import Interpreter
from semmap.nodes.training.language import corpus, made
from semmap.nodes.training.language.household import household
from semmap.nodes.training.language.learning import learn
from tests.data import data_folder


@pytest.mark.long
def test_the_same_examples_give_the_same_files_which_understand_them(tmp_path):
    examples = made.examples(1, household())[::4]
    written = []
    for n in range(2):
        frames, roles = tmp_path / f"frames{n}", tmp_path / f"roles{n}"
        learn(examples, household(), frames, roles)
        written.append((frames.read_bytes(), roles.read_bytes()))
    assert written[0] == written[1]
    pairs, _ = trials.read(examples, Interpreter(str(frames), str(roles)))
    found = scores(pairs)
    assert found.frames > 0.95
    assert found.spans > 0.9


@pytest.mark.long
def test_a_folder_that_was_not_learnt_from_is_understood():
    examples = corpus.read(data_folder() / "huric")
    learnt_from, kept = list(trials.groups(examples))[-1]
    found = scores(trials.trial(iter([(learnt_from, kept)])))
    assert len(kept) > 30
    assert found.frames >= 0.88
    assert found.whole >= 0.52
