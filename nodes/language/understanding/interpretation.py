"""Converts a sentence to semantic frames, with arguments that are resolved to entities of the map."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from importlib import resources
from typing import Final

import pycrfsuite

from semmap.nodes.language import language_detection, lexicon
from semmap.nodes.language.understanding import (
    conjuncts,
    grounding,
    italian,
    moods,
    predicates,
    pronouns,
    referents,
    roles,
    slots,
)
from semmap.nodes.language.understanding.conjuncts import Span
from semmap.nodes.language.understanding.gloss import Gloss
from semmap.nodes.language.understanding.grounding import Scene, Thing, Things
from semmap.nodes.language.understanding.referents import Referents, Resolve
from semmap.nodes.language.understanding.sentence import Sentence, sentence
from semmap.nodes.language.words import PartOfSpeech, split
from semmap.schemas import errors
from semmap.schemas.language import Argument, Grounded, Language, SemanticFrame, Understood

_LEAST: Final = 0.05  # less probable frames are ignored
_WEIGHT_OF_ROLES: Final = 0.5  # of the roles' log-probability relative to the frame's
_DESCRIBED: Final = frozenset({"thing", "place", "beneficiary", "goal", "source", "path", "category", "area"})
"""The slots that entities fill."""
Seen = Callable[[list[list[str]]], list[list[str]]]


class Interpreter:
    """Interprets commands with trained sequence taggers. Not thread-safe."""

    def __init__(
        self, frames: str, roles: str, language: str = "english", seen: Seen = lambda features: features
    ) -> None:
        """Load the taggers from the paths `frames` and `roles`, as `make train-language` writes them.

        `seen` filters the features of each word, as in training.
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
        resolve: Resolve | None = None,
    ) -> Understood:
        """Return the frames of a command, in the order of their verbs, with arguments grounded in a map.

        Without a `language`, it is detected. `resolve` resolves noun phrases in the whole map. With it, each
        thing in a list becomes an argument, and a relative clause (*that is on the desk*) is not a frame.
        Without it, the frames follow the conventions of the corpus.
        """
        if (language or language_detection.detect_language(text)) == "english":
            return self.read(split(text), scene, resolve=resolve)
        gloss = italian.gloss(text, scene)
        return gloss.map_back(self.read(gloss.texts, scene, gloss.kinds, resolve, gloss), "italian")

    def read(
        self,
        texts: Sequence[str],
        scene: Scene,
        kinds: Sequence[PartOfSpeech | None] = (),
        resolve: Resolve | None = None,
        gloss: Gloss | None = None,
    ) -> Understood:
        """Interpret lower-case English words.

        `kinds` are the known parts of speech. `gloss` is the translation that the words come from, if any.
        """
        s = sentence(texts, scene, self._lexicon, kinds)
        mood = moods.mood(s)
        calls = self._calls(s) if texts and mood == "command" else []
        verbs = [_verb(s, first, last) for first, last, _ in calls]
        frames: list[SemanticFrame] = []
        original = _words(s) if gloss is None else gloss.original_words
        plural = frozenset(i for i, word in enumerate(gloss.words if gloss else ()) if word.is_plural)
        look_up = None if resolve is None else Referents(s, scene.things.get, resolve, original, plural)
        for (first, last, found), verb in zip(calls, verbs, strict=True):
            name, spans = self._filled(s, verb, found, [other for other in verbs if other != verb])
            if look_up is None:
                frames.append(_frame(s, name, (first, last), spans, frames, scene, None))
            elif not (name.startswith("Being_") and frames and referents.is_relative(s, verb)):
                for clause in conjuncts.clauses(s, name, verb, spans):
                    frames.append(_frame(s, name, (first, last), clause, frames, scene, look_up))
        unknown = tuple(word.text for i, word in enumerate(s.words) if _is_unknown_verb(s, i))
        if mood == "command" and not frames and not unknown:  # "stop" alone
            unknown = tuple(word.text for word in s.words if word.kind == "verb")
        return Understood(tuple(texts), tuple(frames), _grounded(s, frames), unknown, mood=mood)

    def _calls(self, s: Sentence) -> list[tuple[int, int, list[tuple[float, str]]]]:
        """Return the words that evoke frames (first, last), with the frames' probabilities."""
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
    ) -> tuple[str, list[Span]]:
        """Return the frame that is most probable together with its roles, and its slot fillers."""
        best: tuple[float, str, list[str]] | None = None
        for probability, name in found:
            self._roles.set(self._seen(roles.features(s, verb, name, others)))
            labels = self._roles.tag()
            score = math.log(probability) + _WEIGHT_OF_ROLES * math.log(
                max(self._roles.probability(labels), 1e-300)
            )
            if best is None or score > best[0]:
                best = (score, name, labels)
        if best is None:
            raise errors.InternalError("a verb has no candidate frame")
        return best[1], _spans(best[2])


@functools.cache
def shipped(language: str = "english") -> Interpreter:
    """Return the interpreter with the shipped taggers, which `make train-language` trains."""
    folder = resources.files("semmap.nodes.language") / "learnt"
    return Interpreter(
        str(folder / f"{language}_frames.crfsuite"), str(folder / f"{language}_roles.crfsuite"), language
    )


def _is_unknown_verb(s: Sentence, i: int) -> bool:
    return s.words[i].kind == "verb" and not s.verb_frames(i)


def _is_new_verb(s: Sentence, i: int) -> bool:
    return s.words[i].kind == "verb" and s.words[i - 1].kind == "verb" and s.words[i - 1].text != "let"


def _verb(s: Sentence, first: int, last: int) -> int:
    """Return the index of the verb that the roles relate to: in `there is`, the second word."""
    return last if s.words[first].text == "there" else first


def _spans(labels: Sequence[str]) -> list[Span]:
    """Return the runs of words with the same label; `B-` begins a new run."""
    spans: list[Span] = []
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
    spans: Sequence[Span],
    before: Sequence[SemanticFrame],
    scene: Scene,
    look_up: Referents | None,
) -> SemanticFrame:
    arguments: list[Argument] = []
    source: tuple[int, str] | None = None
    opened = {span: found for span in spans if look_up and (found := _opened(s, name, span, scene))}
    heads = {span: opened[span][0] if span in opened else _head(s, *span) for span in spans}
    meant = dict[Span, Things]()
    for span in sorted(spans, key=lambda span: span[0] != "source"):
        slot, first, last = span
        k = s.phrase_of[heads[span]]
        if span in opened:
            meant[span] = opened[span][1]
        elif look_up is None or slot not in _DESCRIBED:
            meant[span] = referents.chosen(s, first, last, k)
        else:
            where = source if slot == "thing" else None
            meant[span] = look_up.of(first, last, heads[span], where, _like(s, spans, span))
        if slot == "source" and len(meant[span]) == 1:
            source = k, meant[span][0].name
    for span in spans:
        slot, first, last = span
        head, things = heads[span], meant[span]
        k = s.phrase_of[head]
        branch = "" if span in opened else s.branches[k]
        role = slots.role(name, slot, branch, s.words[verb[0]].lemma)
        names = tuple(sorted(thing.name for thing in things))
        ambiguous = referents.means_one(s, k)
        if s.branches[k] == "pronoun" and not names:
            pronoun = s.words[head].text
            names = pronouns.antecedent(pronoun, s.phrases[k].preposition, name, role, before, scene)
            ambiguous = any(
                names == a.candidates and a.ambiguous for frame in before for a in frame.arguments
            )
        several = len(names) > 1
        arguments.append(
            Argument(
                role,
                " ".join(word.text for word in s.words[first : last + 1]),
                (first + 1, last + 1),
                head + 1,
                names[0] if len(names) == 1 else None,
                names if several else (),
                several and ambiguous,
                _number(s, k),
            )
        )
    negated = any(word.kind == "neg" for word in s.words[max(0, verb[0] - 2) : verb[0]])
    negated = negated and "why" not in [word.text for word in s.words[: verb[0]]]
    return SemanticFrame(name, tuple(range(verb[0] + 1, verb[1] + 2)), tuple(arguments), negated)


def _head(s: Sentence, slot: str, first: int, last: int) -> int:
    """Return the head of an argument: the head of its first phrase, or the number of an angle."""
    if slot == "angle":
        return next((i for i in range(first, last + 1) if s.words[i].kind == "num"), last)
    phrases = (s.phrases[k] for k in range(s.phrase_of[first], s.phrase_of[last] + 1))
    head = next((phrase.head for phrase in phrases if phrase.names), last)
    return min(max(head, first), last)


def _number(s: Sentence, k: int) -> int | None:
    """Return the number of things in a phrase, if it contains a numeral."""
    phrase, number_words = s.phrases[k], s.lexicon.numbers
    if s.branches[k] in ("", "measure", "pronoun") or not s.candidates[k]:
        return None
    numerals = [w.text for w in s.words[phrase.nominal : phrase.head] if w.kind == "num"]
    if len(numerals) != 1:
        return None
    (numeral,) = numerals
    return int(numeral) if numeral.isdecimal() and len(numeral) < 4 else number_words.get(numeral)


def _opened(s: Sentence, frame: str, span: Span, scene: Scene) -> tuple[int, Things] | None:
    """Return the thing that a door belongs to, and its word: *the door of the fridge*."""
    head = _head(s, *span)
    k = s.phrase_of[head]
    if frame != "Closure" or span[0] != "thing" or s.branches[k] != "Door":
        return None
    word, things = (
        head - 1,
        grounding.find_by_label(s.words[head - 1].text, scene, s.lexicon),
    )  # "the fridge door"
    if k + 1 < len(s.phrases) and s.phrases[k + 1].preposition == "of" and s.phrases[k + 1].last <= span[2]:
        word, things = s.phrases[k + 1].head, s.candidates[k + 1]
    kinds = [scene.kinds_of(thing.name) for thing in things]
    opens = bool(kinds) and all("Openable_Thing" in kind and "Location" not in kind for kind in kinds)
    return (word, things) if opens else None


def _like(s: Sentence, spans: Sequence[Span], span: Span) -> str:
    """Return the noun that an elliptical phrase omits (*the blue cup and the red one*), or ""."""
    slot, first, last = span
    alone = [word for word in s.words[first : last + 1] if word.kind not in ("det", "rel")]
    is_such = all(word.text in ("one", "ones") or s.lexicon.is_a(word.text, "adjective") for word in alone)
    before = [other for other in spans if other[0] == slot and other[2] < first]
    if not alone or not is_such or not before or s.candidates[s.phrase_of[last]]:
        return ""
    return s.words[_head(s, *before[-1])].text


def _words(s: Sentence) -> Callable[[int, int], str]:
    """Return a function that joins the words from one index to another."""
    return lambda first, last: " ".join(word.text for word in s.words[first : last + 1])


def _grounded(s: Sentence, frames: Sequence[SemanticFrame]) -> tuple[Grounded, ...]:
    """Return the entity for each word of an argument that names one."""
    named: dict[int, str] = {}
    heads = {argument.head: argument.entity for frame in frames for argument in frame.arguments}
    for frame in frames:
        for argument in frame.arguments:
            for i in range(argument.span[0] - 1, argument.span[1]):
                phrase = s.phrases[s.phrase_of[i]]
                if i >= phrase.nominal and s.words[i].kind in ("noun", "adj", "pron"):
                    things: tuple[Thing, ...] = s.candidates[s.phrase_of[i]]
                    name = heads.get(phrase.head + 1) or (things[0].name if len(things) == 1 else None)
                    if name is not None:
                        named[i + 1] = name
    return tuple(Grounded(token, name) for token, name in sorted(named.items()))
