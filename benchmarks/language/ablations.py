"""Ablations: the same trials without one source of knowledge, including training."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Final

from benchmarks.language import trials
from benchmarks.language.scoring import scores
from benchmarks.table import Row
from semmap.nodes.language.understanding.interpretation import Seen
from semmap.nodes.training.language.corpus import Example
from semmap.nodes.training.language.household import household

GROUPS: Final = {  # a feature is of a group if it mentions it, also together with others
    "the word itself": r"\bw=",
    "neighbouring words": r"(^|\|)[+-]?1=|\bprevw=",
    "parts of speech": r"pos=",
    "the verb's base form": r"\bv=",
    "frames of the verb by the lexicon": r"\b(frames|may|rank\d)=",
    "lists of words (directions, states, ...)": r"\blisted ",
    "phrases and prepositions": r"\b(pp|lastpp|prep|prevprep|shape|first|npps|nnps|pps|nps)=",
    "the place among the phrases": r"\b(in|steps|left|last|at)=",
    "kinds of things": r"kinds?=",
    "near or far in the map": r"\bnear( last)?=",
}
"""Groups of features of `predicates` and `roles`, with patterns of their names."""


def rows(examples: list[Example]) -> Iterator[Row]:
    """Yield scores of frames, heads and whole commands without one source each."""
    trials_without: dict[str, dict[str, Any]] = {
        "nothing": {},
        "patterns of ours": {"with_made": False},
        "the corpus": {"with_corpus": False},
        "the map's positions": {"changed": _without_places},
        "synonyms": {"known": household(synonyms=False)},
        **{title: {"seen": without(pattern)} for title, pattern in GROUPS.items()},
    }
    for title, options in trials_without.items():
        for name, splits in (("five folds", _five), ("a folder left out", trials.groups)):
            found = scores(trials.trial(splits(examples), **options))
            for what, value in (
                ("frames, F1", found.frames),
                ("heads end to end, F1", found.heads),
                ("whole command", found.whole),
            ):
                yield Row(f"without {title}, {name}: {what}", value, "", more=True)


def _five(examples: list[Example]) -> Iterator[trials.Split]:
    return trials.folds(examples, 5)


def without(pattern: str) -> Seen:
    """Return a filter for the features whose names match a pattern."""
    found = re.compile(pattern)
    return lambda features: [[f for f in word if not found.search(f)] for word in features]


def _without_places(example: Example) -> Example:
    return replace(example, things=tuple(replace(thing, at=None) for thing in example.things))
