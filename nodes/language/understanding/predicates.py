"""Features for the tagger that decides whether a word evokes a frame, and which one."""

from __future__ import annotations

from semmap.nodes.language.understanding.sentence import Sentence

_GOALS = ("to", "into", "onto", "towards")


def features(s: Sentence) -> list[list[str]]:
    """Return the features of each word."""
    return [_of_word(s, i) for i in range(len(s.words))]


def may_call(s: Sentence, i: int) -> bool:
    """Return whether the word at i can evoke a frame."""
    return s.words[i].kind in ("verb", "aux") or s.words[i].text == "there"


def _of_word(s: Sentence, i: int) -> list[str]:
    word = s.words[i]
    seen = ["bias", f"w={word.text}", f"pos={word.kind}"]
    for step in (-1, 1):
        inside = 0 <= i + step < len(s.words)
        seen.append(f"{step}={s.words[i + step].text if inside else '|'}")
        seen.append(f"{step}pos={s.words[i + step].kind if inside else '|'}")
    if not may_call(s, i):
        return [*seen, "no verb"]
    frames = s.verb_frames(i)
    among = "+".join(sorted(frames))
    seen += [f"v={word.lemma}", f"frames={among}"]
    for rank, frame in enumerate(frames):
        seen += [f"may={frame}", f"rank{rank}={frame}"]
    around = _clause(s, i)
    return [
        *seen,
        *around,
        *(f"v={word.lemma}|{text}" for text in around),
        *(f"frames={among}|{text}" for text in around),
    ]


def _clause(s: Sentence, i: int) -> list[str]:
    """Return the features of the verb's clause."""
    after = s.clause(i)
    things = [k for k in after if s.phrases[k].kind == "np"]
    places = [k for k in after if s.phrases[k].kind == "pp"]
    shape = [s.phrases[k].preposition or s.phrases[k].kind for k in after]
    seen = [f"shape={' '.join(shape[:4])}", f"first={shape[0] if shape else ''}"]
    seen += [f"npps={len(places)}", f"nnps={len(things)}"]
    if things:
        seen.append(f"object kind={s.branches[things[0]]}")
    if len(things) > 1:
        seen.append(f"objects kinds={s.branches[things[0]]} {s.branches[things[1]]}")
    for k in places:
        preposition, branch = s.phrases[k].preposition, s.branches[k]
        seen += [f"pp={preposition}", f"pp={preposition} kind={branch}", f"pp kind={branch}"]
    if places:
        seen.append(f"lastpp={s.phrases[places[-1]].preposition}")
    if any(s.phrases[k].preposition in _GOALS for k in places):
        seen.append("pp=goal")
    for k in after:
        for word in s.words[s.phrases[k].first : s.phrases[k].last + 1]:
            for kind in ("direction", "state", "manner", "speaker"):
                if s.lexicon.is_a(word.text, kind) and word.kind != "prep":
                    seen.append(f"listed {kind}")
    if things and places:
        nearest = s.near(things[0], places[0])
        seen += [
            f"near={nearest}",
            f"near last={s.near(things[0], places[-1])}",
            f"near={nearest} npps={len(places)}",
        ]
    return seen
