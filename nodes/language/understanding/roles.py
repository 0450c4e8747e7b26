"""Features for the tagger that assigns words to the slots of a frame."""

from __future__ import annotations

from collections.abc import Sequence

from semmap.nodes.language.understanding.sentence import Sentence


def features(s: Sentence, verb: int, frame: str, others: Sequence[int]) -> list[list[str]]:
    """Return the features of each word relative to a frame's verb; `others` evoke other frames."""
    after = s.clause(verb)
    return [_of_word(s, i, verb, frame, others, after) for i in range(len(s.words))]


def _of_word(s: Sentence, i: int, verb: int, frame: str, others: Sequence[int], after: range) -> list[str]:
    word, k = s.words[i], s.phrase_of[i]
    phrase = s.phrases[k]
    begin = "B" if i == phrase.first else "I"
    preposition, branch = phrase.preposition or phrase.kind, s.branches[k] or word.kind
    between = sum(min(verb, i) < other < max(verb, i) for other in others)
    where = f"{'at' if i == verb else 'before' if i < verb else 'after'}{min(between, 2)}"
    inside = k in after
    kinds = [s.phrases[j].kind for j in after]
    here = k - after.start
    places_before, things_before = (
        (kinds[:here].count("pp"), kinds[:here].count("np")) if inside else (-1, -1)
    )
    places_after = kinds[here + 1 :].count("pp") if inside else -1
    last = inside and not {"np", "pp"} & set(kinds[here + 1 :])
    steps = max(-4, min(k - s.phrase_of[verb], 5))
    seen = [
        f"w={word.text}",
        f"pos={word.kind}",
        begin,
        f"{begin} prep={preposition}",
        f"{begin} kind={branch}",
        f"{begin} prep={preposition} kind={branch}",
        f"at={where}",
        f"{begin} at={where}",
        f"{begin} at={where} prep={preposition}",
        f"{begin} in={inside} steps={steps}",
        f"{begin} in={inside} pps={places_before} nps={things_before} prep={preposition}",
        f"{begin} left={places_after} pps={places_before} nps={things_before}",
        f"{begin} last={last} prep={preposition}",
    ]
    if k:
        previous = s.phrases[k - 1]
        seen += [
            f"{begin} prevprep={previous.preposition or previous.kind} prep={preposition}",
            f"{begin} prevkind={s.branches[k - 1]} prep={preposition}",
            f"{begin} prevw={s.words[phrase.first - 1].text}",
        ]
        if phrase.kind == "pp" and previous.names:
            nearness = s.near(k - 1, k)
            seen += [
                f"{begin} near={nearness}",
                f"{begin} near={nearness} left={places_after} pps={places_before}",
            ]
    if i + 1 < len(s.words):
        seen += [f"+1={s.words[i + 1].text}", f"+1pos={s.words[i + 1].kind}"]
    if i:
        seen.append(f"-1={s.words[i - 1].text}")
    for kind in ("direction", "state", "manner", "unit", "number"):
        if s.lexicon.is_a(word.text, kind):
            seen.append(f"listed {kind} at={where}")
    if i in others:
        seen.append("other verb")
    lemma = s.words[verb].lemma
    with_verb = [f"v={lemma}|{text}" for text in seen[2:6]]
    return ["bias", f"frame={frame}", *seen, *(f"{frame}|{text}" for text in seen), *with_verb]
