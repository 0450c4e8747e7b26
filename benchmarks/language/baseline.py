"""The baseline: the most frequent frame and roles, and the most similar label."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from rapidfuzz.distance import Levenshtein

from benchmarks.language.trials import Pairs, Split, scene_of
from semmap.nodes.language import lexicon
from semmap.nodes.language.understanding.grounding import Thing
from semmap.nodes.language.understanding.sentence import Sentence, sentence
from semmap.nodes.training.language.corpus import Example
from semmap.schemas.language import Argument, Grounded, SemanticFrame, Understood

_ENOUGH = 0.7  # similarity of a word to a label


def pairs(splits: Iterator[Split]) -> Pairs:
    """Return the baseline's results, trained on the rest."""
    found: Pairs = []
    for learnt_from, kept in splits:
        verbs: dict[str, Counter[str]] = {}
        roles: dict[tuple[str, str], Counter[str]] = {}
        for example in learnt_from:
            s = _read(example)
            for frame in example.frames:
                verbs.setdefault(s.words[frame.verb[0] - 1].lemma, Counter())[frame.name] += 1
                for role in frame.arguments:
                    key = (frame.name, s.phrases[s.phrase_of[role.first - 1]].preposition)
                    roles.setdefault(key, Counter())[role.name] += 1
        found += [(example, _understood(example, verbs, roles)) for example in kept]
    return found


def _read(example: Example) -> Sentence:
    return sentence(example.words, scene_of(example), lexicon.load())


def _understood(
    example: Example, verbs: dict[str, Counter[str]], roles: dict[tuple[str, str], Counter[str]]
) -> Understood:
    s = _read(example)
    frames = []
    groundings: dict[int, str] = {}
    for i, word in enumerate(s.words):
        if word.kind != "verb" or word.lemma not in verbs:
            continue
        name = verbs[word.lemma].most_common(1)[0][0]
        arguments = []
        for k in s.clause(i):
            phrase = s.phrases[k]
            known = roles.get((name, phrase.preposition))
            if not phrase.names or known is None:
                continue
            entity = _nearest(s.words[phrase.head].text, example.things)
            if entity is not None:
                groundings[phrase.head + 1] = entity
            text = " ".join(w.text for w in s.words[phrase.first : phrase.last + 1])
            span = (phrase.first + 1, phrase.last + 1)
            arguments.append(Argument(known.most_common(1)[0][0], text, span, phrase.head + 1, entity))
        frames.append(SemanticFrame(name, (i + 1,), tuple(arguments)))
    return Understood(
        example.words, tuple(frames), tuple(Grounded(t, e) for t, e in sorted(groundings.items()))
    )


def _nearest(word: str, things: tuple[Thing, ...]) -> str | None:
    similar = [
        (Levenshtein.normalized_similarity(word, text.lower()), thing.name)
        for thing in things
        for text in thing.references[:1]
    ]
    best = max(similar, default=(0.0, ""))
    return best[1] if best[0] >= _ENOUGH else None
