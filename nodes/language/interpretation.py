"""From a sentence and a map to frames, what fills their roles, and which entities are meant."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from importlib import resources
from typing import Final

import pycrfsuite

from nodes.language import grounding, italian, languages, lexicon, moods, predicates, pronouns, roles, slots
from nodes.language.grounding import Scene, Thing, Things
from nodes.language.sentence import Sentence, sentence
from nodes.language.words import PartOfSpeech, split
from schemas.language import Argument, Frame, Grounded, Language, Understood

_LEAST: Final = 0.05  # a frame less probable than this is not looked at
_WEIGHT_OF_ROLES: Final = 0.5  # of the roles' log-probability against the frame's
Narrow = Callable[[str, tuple[str, ...]], tuple[str, ...]]
"""Of the entities that words may mean, by name, those that they do: whoever sees the whole map knows more."""
Seen = Callable[[list[list[str]]], list[list[str]]]
_Span = tuple[str, int, int]  # slot, index of the first and of the last word


class Interpreter:
    """Reads commands with what was learnt of a language. One thread at a time."""

    def __init__(
        self, frames: str, roles: str, language: str = "english", seen: Seen = lambda features: features
    ) -> None:
        """frames, roles: paths of the learnt taggers, as `make train-language` writes them.

        seen: what is left of the features of each word; the same as was given for learning.
        """
        self._lexicon = lexicon.load(language)
        self._seen = seen
        self._frames, self._roles = pycrfsuite.Tagger(), pycrfsuite.Tagger()
        self._frames.open(frames)
        self._roles.open(roles)

    def understand(
        self,
        text: str,
        scene: Scene,
        language: Language | None = None,
        narrow: Narrow = lambda _, names: names,
    ) -> Understood:
        """The frames of a command, in the order of their verbs, with their arguments grounded in a map.

        language: what it is said in; without one its words tell. narrow: asked where several entities may be
        meant, with the English words for them.
        """
        if (language or languages.language_of(text)) == "english":
            return self.read(split(text), scene, narrow=narrow)
        told = italian.gloss(text, scene)
        return told.told_back(self.read(told.texts, scene, told.kinds, narrow), "italian")

    def read(
        self,
        texts: Sequence[str],
        scene: Scene,
        kinds: Sequence[PartOfSpeech | None] = (),
        narrow: Narrow = lambda _, names: names,
    ) -> Understood:
        """The same of lower-case English words. kinds: the parts of speech that are known."""
        s = sentence(texts, scene, self._lexicon, kinds)
        mood = moods.mood(s)
        calls = self._calls(s) if texts and mood == "command" else []
        verbs = [_verb(s, first, last) for first, last, _ in calls]
        frames: list[Frame] = []
        for (first, last, found), verb in zip(calls, verbs, strict=True):
            name, spans = self._filled(s, verb, found, [other for other in verbs if other != verb])
            frames.append(_frame(s, name, (first, last), spans, frames, scene, narrow))
        unknown = (word.text for i, word in enumerate(s.words) if _is_unknown_verb(s, i))
        return Understood(tuple(texts), tuple(frames), _grounded(s, frames), tuple(unknown), mood=mood)

    def _calls(self, s: Sentence) -> list[tuple[int, int, list[tuple[float, str]]]]:
        """Where frames are called for: first and last word, and the frames with their probabilities."""
        self._frames.set(self._seen(predicates.features(s)))
        labels = self._frames.tag()
        calls: list[tuple[int, int, list[tuple[float, str]]]] = []
        for i, label in enumerate(labels):
            if label == "O" or _is_unknown_verb(s, i) or moods.is_over(s, i):
                continue
            if calls and calls[-1][1] == i - 1 and labels[i - 1] == label and not _is_new_verb(s, i):
                calls[-1] = (calls[-1][0], i, calls[-1][2])
                continue
            probable = [
                (self._frames.marginal(name, i), name) for name in self._frames.labels() if name != "O"
            ]
            calls.append((i, i, [found for found in probable if found[0] > _LEAST] or [(1.0, label)]))
        return calls

    def _filled(
        self, s: Sentence, verb: int, found: list[tuple[float, str]], others: list[int]
    ) -> tuple[str, list[_Span]]:
        """The frame that together with its roles is the most probable, and what fills its slots."""
        best: tuple[float, str, list[str]] | None = None
        for probability, name in found:
            self._roles.set(self._seen(roles.features(s, verb, name, others)))
            labels = self._roles.tag()
            score = math.log(probability) + _WEIGHT_OF_ROLES * math.log(
                max(self._roles.probability(labels), 1e-300)
            )
            if best is None or score > best[0]:
                best = (score, name, labels)
        assert best is not None
        return best[1], _spans(best[2])


@functools.cache
def shipped(language: str = "english") -> Interpreter:
    """The interpreter that comes with the package, learnt by `make train-language`."""
    folder = resources.files(__package__) / "learnt"
    return Interpreter(
        str(folder / f"{language}_frames.crfsuite"), str(folder / f"{language}_roles.crfsuite"), language
    )


def _is_unknown_verb(s: Sentence, i: int) -> bool:
    return s.words[i].kind == "verb" and not s.verb_frames(i)


def _is_new_verb(s: Sentence, i: int) -> bool:
    return s.words[i].kind == "verb" and s.words[i - 1].kind == "verb" and s.words[i - 1].text != "let"


def _verb(s: Sentence, first: int, last: int) -> int:
    """The word that the roles are seen from: of `there is` the latter."""
    return last if s.words[first].text == "there" else first


def _spans(labels: Sequence[str]) -> list[_Span]:
    """The runs of words with one label, `B-` beginning a new one."""
    spans: list[_Span] = []
    open_slot = ""
    for i, label in enumerate(labels):
        slot = label[2:]
        if not slot:
            open_slot = ""
        elif label.startswith("I-") and slot == open_slot:
            spans[-1] = (slot, spans[-1][1], i)
        else:
            spans.append((slot, i, i))
            open_slot = slot
    return spans


def _frame(
    s: Sentence,
    name: str,
    verb: tuple[int, int],
    spans: Sequence[_Span],
    before: Sequence[Frame],
    scene: Scene,
    narrow: Narrow,
) -> Frame:
    arguments: list[Argument] = []
    for slot, first, last in spans:
        head = _head(s, slot, first, last)
        k = s.phrase_of[head]
        role = slots.role(name, slot, s.branches[k], s.words[verb[0]].lemma)
        things = _chosen(s, first, last, k, narrow)
        entity = things[0].name if len(things) == 1 else None
        if s.branches[k] == "pronoun" and entity is None:
            phrase, said = s.phrases[k], s.words[head].text
            entity = pronouns.antecedent(said, phrase.preposition, name, role, before, scene)
        arguments.append(
            Argument(
                role,
                " ".join(word.text for word in s.words[first : last + 1]),
                (first + 1, last + 1),
                head + 1,
                entity,
                tuple(sorted(thing.name for thing in things)) if len(things) > 1 else (),
                len(things) > 1 and _means_one(s, k),
            )
        )
    negated = any(word.kind == "neg" for word in s.words[max(0, verb[0] - 2) : verb[0]])
    negated = negated and "why" not in [word.text for word in s.words[: verb[0]]]
    return Frame(name, tuple(range(verb[0] + 1, verb[1] + 2)), tuple(arguments), negated)


def _head(s: Sentence, slot: str, first: int, last: int) -> int:
    """The word that an argument is about: the head of its first phrase, of an angle the number."""
    if slot == "angle":
        return next((i for i in range(first, last + 1) if s.words[i].kind == "num"), last)
    phrases = (s.phrases[k] for k in range(s.phrase_of[first], s.phrase_of[last] + 1))
    head = next((phrase.head for phrase in phrases if phrase.names), last)
    return min(max(head, first), last)


def _means_one(s: Sentence, k: int) -> bool:
    """Whether a phrase speaks of one thing that is known, and not of any or of several."""
    phrase = s.phrases[k]
    inside = s.words[phrase.nominal : phrase.last + 1]
    any_or_several = any(s.lexicon.is_a(word.text, "any_or_several") or word.kind == "num" for word in inside)
    head = s.words[phrase.head]
    return not any_or_several and head.kind == "noun" and (head.text == head.lemma or " " in head.text)


def _chosen(s: Sentence, first: int, last: int, k: int, narrow: Narrow) -> Things:
    """What phrase k may mean; of several what `narrow` says, or the nearest to what else is spoken of."""
    things = s.meant[k]
    if len(things) > 1:
        names = tuple(thing.name for thing in things)
        words = (word.text for word in s.words[s.phrases[k].nominal : last + 1])
        if left := set(narrow(" ".join(words), names)) & set(names):
            narrowed = tuple(thing for thing in things if thing.name in left)
            if len(narrowed) < len(things):
                return narrowed
    beside = [
        s.meant[other][0]
        for other in range(s.phrase_of[first], s.phrase_of[last] + 1)
        if other != k and len(s.meant[other]) == 1
    ]
    if len(things) < 2 or not beside:
        return things
    nearest = min(grounding.distance(thing, beside[0]) for thing in things)
    return tuple(thing for thing in things if grounding.distance(thing, beside[0]) == nearest)


def _grounded(s: Sentence, frames: Sequence[Frame]) -> tuple[Grounded, ...]:
    """For each word of an argument that names an entity which."""
    told: dict[int, str] = {}
    heads = {argument.head: argument.entity for frame in frames for argument in frame.arguments}
    for frame in frames:
        for argument in frame.arguments:
            for i in range(argument.span[0] - 1, argument.span[1]):
                phrase = s.phrases[s.phrase_of[i]]
                if i >= phrase.nominal and s.words[i].kind in ("noun", "adj", "pron"):
                    things: tuple[Thing, ...] = s.meant[s.phrase_of[i]]
                    name = heads.get(phrase.head + 1) or (things[0].name if len(things) == 1 else None)
                    if name is not None:
                        told[i + 1] = name
    return tuple(Grounded(token, name) for token, name in sorted(told.items()))
