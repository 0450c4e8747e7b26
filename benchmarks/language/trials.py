"""Cross-validation on the corpus."""

from __future__ import annotations

import json
import random
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from importlib import resources
from pathlib import Path
from statistics import median
from typing import Any

from semmap.nodes.language import lexicon
from semmap.nodes.language.understanding.grounding import Scene, Thing, scene
from semmap.nodes.language.understanding.interpretation import Interpreter, Seen, shipped
from semmap.nodes.language.vocabulary import Vocabulary
from semmap.nodes.training.language import made
from semmap.nodes.training.language.__main__ import TIMES_MADE
from semmap.nodes.training.language.corpus import Example, Filled, Role
from semmap.nodes.training.language.household import household
from semmap.nodes.training.language.learning import learn
from semmap.schemas.language import Understood

Pairs = list[tuple[Example, Understood]]
Split = tuple[list[Example], list[Example]]  # to learn from, to be read


def folds(examples: Sequence[Example], number: int = 10, seed: int = 1) -> Iterator[Split]:
    """Return ten folds; every example is tested once by taggers trained on the other nine tenths."""
    shuffled = random.Random(seed).sample(list(examples), len(examples))
    for k in range(number):
        yield [e for i, e in enumerate(shuffled) if i % number != k], shuffled[k::number]


def groups(examples: Sequence[Example]) -> Iterator[Split]:
    """Return one fold per folder, tested by taggers trained on the others."""
    for group in sorted({example.group for example in examples}):
        yield [e for e in examples if e.group != group], [e for e in examples if e.group == group]


def trial(
    splits: Iterator[Split],
    *,
    with_made: bool = True,
    with_corpus: bool = True,
    changed: Callable[[Example], Example] = lambda example: example,
    seen: Seen = lambda features: features,
    known: Vocabulary | None = None,
) -> Pairs:
    """Return the predictions for all test examples by taggers trained on the rest.

    changed, seen: what is done to every example, and to the features of its words, also while learning.
    known: what things are called, the household TBox's classes and our synonyms unless said otherwise.
    """
    known = known or household()
    own = [changed(e) for e in made.examples(TIMES_MADE, known)] if with_made else []
    pairs: Pairs = []
    with tempfile.TemporaryDirectory() as folder:
        frames, fillers = Path(folder) / "frames", Path(folder) / "roles"
        for learnt_from, kept in splits:
            examples = [*(map(changed, learnt_from) if with_corpus else ()), *own]
            learn(examples, known, frames, fillers, seen=seen)
            interpreter = Interpreter(str(frames), str(fillers), seen=seen)
            pairs += [(e, interpreter.read(e.words, scene_of(changed(e), known=known))) for e in kept]
    return pairs


def read(examples: Sequence[Example], interpreter: Interpreter) -> tuple[Pairs, float]:
    """Return the predictions from words and map alone, and the median duration per sentence [ms]."""
    pairs: Pairs = []
    times = []
    for example in examples:
        there = scene_of(example)
        began = time.perf_counter()
        understood = interpreter.read(example.words, there)
        times.append((time.perf_counter() - began) * 1e3)
        pairs.append((example, understood))
    return pairs, median(times)


def scene_of(example: Example, seed: int = 0, known: Vocabulary | None = None) -> Scene:
    """Return the map of an example in random order, as the order of names reveals the mentioned entities."""
    things: list[Thing] = random.Random(f"{seed} {example.name}").sample(example.things, len(example.things))
    return scene(things, known or household(), lexicon.load())


def italian(corpus: Sequence[Example]) -> Pairs:
    """Return the shipped taggers' predictions for the Italian commands of `italian.json`."""
    by_name = {example.name: example for example in corpus}
    text = (resources.files(__package__) / "italian.json").read_text("utf-8")
    pairs: Pairs = []
    for row in json.loads(text)["commands"]:
        example = _italian(row, by_name[row["id"]])
        pairs.append((example, shipped().understand(row["text"], scene_of(example))))
    return pairs


def _italian(row: dict[str, Any], original: Example) -> Example:
    frames = tuple(
        Filled(
            frame["name"],
            tuple(frame["verb"]),
            tuple(Role(a["role"], a["span"][0], a["span"][1], a["head"]) for a in frame["arguments"]),
        )
        for frame in row["frames"]
    )
    groundings = tuple(
        (a["head"], a["entity"]) for frame in row["frames"] for a in frame["arguments"] if "entity" in a
    )
    return replace(original, words=tuple(row["words"].split()), frames=frames, groundings=groundings)
