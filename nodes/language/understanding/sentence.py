"""The analysis of a sentence before the trained taggers: words, phrases and candidate entities."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from semmap.nodes.language.lexicon import Lexicon
from semmap.nodes.language.phrases import Phrase, phrases
from semmap.nodes.language.understanding import grounding
from semmap.nodes.language.understanding.grounding import Scene, Things
from semmap.nodes.language.words import PartOfSpeech, Word, tag, to_base_forms

_MOST_PAIRS = 400  # pairs of things that are searched for the nearest; takes 0.1 ms
_NEAR_M = 1.5  # people locate objects relative to others within this distance


@dataclass(frozen=True, slots=True)
class Sentence:
    """Words, phrases, and the candidate entities of each phrase."""

    words: Sequence[Word]
    phrases: Sequence[Phrase]
    phrase_of: Sequence[int]  # the index of each word's phrase
    branches: Sequence[str]  # the branch of the taxonomy of each phrase, or ""
    candidates: Sequence[Things]  # the candidate entities of each phrase
    lexicon: Lexicon

    def near(self, one: int, other: int) -> Literal["near", "far", "unknown"]:
        """Return whether the nearest entities of two phrases are close to each other on the floor."""
        ones, others = self.candidates[one], self.candidates[other]
        if not 0 < len(ones) * len(others) <= _MOST_PAIRS:
            return "unknown"
        metres = min(grounding.distance(a, b) for a in ones for b in others)
        return "unknown" if metres == float("inf") else "near" if metres < _NEAR_M else "far"

    def clause(self, verb: int) -> range:
        """Return the phrases after a verb, up to the next verb or clause."""
        start = end = self.phrase_of[verb] + 1
        while end < len(self.phrases):
            kind = self.phrases[end].kind
            if kind in ("verb", "aux", "modal", "rel"):
                break
            if kind == "conj" and not (end + 1 < len(self.phrases) and self.phrases[end + 1].names):
                break
            end += 1
        return range(start, end)

    def verb_frames(self, verb: int) -> tuple[str, ...]:
        """Return the frames of a verb in the lexicon, considering its particle."""
        lemma = self.words[verb].lemma
        for i in range(verb + 1, min(verb + 5, len(self.words))):
            if self.words[i].kind == "verb":
                break
            both = f"{lemma} {self.words[i].text}"
            if both in self.lexicon.frames and (i == verb + 1 or self.words[i].kind == "particle"):
                return self.lexicon.frames[both]
        return self.lexicon.frames.get(lemma, ())


def sentence(
    texts: Sequence[str], scene: Scene, lexicon: Lexicon, kinds: Sequence[PartOfSpeech | None] = ()
) -> Sentence:
    """Analyse a sentence of lower-case words; `kinds` are the known parts of speech."""
    words = tag(texts, lexicon, kinds)
    found = phrases(words, lexicon)
    phrase_of = [k for k, phrase in enumerate(found) for _ in range(phrase.first, phrase.last + 1)]
    meant = [
        grounding.find_candidates(phrase, words, scene, lexicon) if phrase.names else () for phrase in found
    ]
    branches = [
        _branch(phrase, words, things, scene, lexicon) if phrase.names else ""
        for phrase, things in zip(found, meant, strict=True)
    ]
    return Sentence(words, found, phrase_of, branches, meant, lexicon)


def _branch(phrase: Phrase, words: Sequence[Word], things: Things, scene: Scene, lexicon: Lexicon) -> str:
    """Return the kind of a phrase: a branch of the taxonomy, or the word class of its head."""
    head = words[phrase.head]
    for kind in ("robot", "speaker"):
        if lexicon.is_a(head.text, kind):
            return kind
    if head.kind == "pron":
        return "pronoun"
    if lexicon.is_a(head.lemma, "unit"):
        return "measure"
    if lexicon.is_a(head.text, "direction"):
        return "direction"
    inside = words[phrase.nominal : phrase.last + 1]
    text = " ".join(word.text for word in inside if word.kind in ("noun", "adj"))
    known = scene.vocabulary
    name = known.class_of(text) or known.class_of(to_base_forms(text, lexicon)) or known.class_of(head.lemma)
    if name is None and things:
        name = known.class_of(things[0].class_name.lower()) or things[0].class_name
    return known.branch(name)
