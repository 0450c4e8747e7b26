"""Training of the two taggers of `semmap.nodes.language`: linear-chain conditional random fields."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

import pycrfsuite

from semmap.nodes.language import lexicon
from semmap.nodes.language.understanding import grounding, predicates, roles, slots
from semmap.nodes.language.understanding.interpretation import Seen
from semmap.nodes.language.understanding.sentence import Sentence, sentence
from semmap.nodes.language.vocabulary import Vocabulary
from semmap.nodes.training.language.corpus import Example, Filled

_PARAMETERS: Final = {"c1": 0.05, "c2": 0.05, "max_iterations": 80, "feature.possible_transitions": True}


def learn(
    examples: Iterable[Example],
    known: Vocabulary,
    frames: Path,
    fillers: Path,
    language: str = "english",
    seen: Seen = lambda features: features,
) -> None:
    """Write what tells frames and what tells roles; the same files for the same examples.

    seen: what is left of the features of each word (to measure what the others are worth).
    """
    words = lexicon.load(language)
    of_frames, of_roles = pycrfsuite.Trainer(verbose=False), pycrfsuite.Trainer(verbose=False)
    for example in examples:
        s = sentence(example.words, grounding.scene(example.things, known, words), words)
        of_frames.append(seen(predicates.features(s)), _frame_labels(example))
        verbs = [_verb(s, frame) for frame in example.frames]
        for frame, verb in zip(example.frames, verbs, strict=True):
            others = [other for other in verbs if other != verb]
            features = seen(roles.features(s, verb, frame.name, others))
            of_roles.append(features, _role_labels(len(s.words), frame))
    for trainer, path in ((of_frames, frames), (of_roles, fillers)):
        trainer.set_params(_PARAMETERS)
        trainer.train(str(path))


def _verb(s: Sentence, frame: Filled) -> int:
    """Return the index of the verb that the roles relate to, as in `interpretation`."""
    first, last = frame.verb[0] - 1, frame.verb[-1] - 1
    return last if s.words[first].text == "there" else first


def _frame_labels(example: Example) -> list[str]:
    labels = ["O"] * len(example.words)
    for frame in example.frames:
        for token in frame.verb:
            labels[token - 1] = frame.name
    return labels


def _role_labels(length: int, frame: Filled) -> Sequence[str]:
    labels = ["O"] * length
    for role in frame.arguments:
        slot = slots.slot(frame.name, role.name)
        labels[role.first - 1] = f"B-{slot}"
        labels[role.first : role.last] = [f"I-{slot}"] * (role.last - role.first)
    return labels
