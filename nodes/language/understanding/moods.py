"""The mood of a sentence: command, question or statement about the past."""

from __future__ import annotations

from semmap.nodes.language.understanding.sentence import Sentence
from semmap.schemas.language import Mood

_NOT_YET = ("adv", "conj", "neg")  # words that may precede the first word of a question


def mood(s: Sentence) -> Mood:
    """Return whether a sentence is a question or only about the past; otherwise it is a command."""
    if _asks(s):
        return "question"
    verbs = [i for i, word in enumerate(s.words) if word.kind in ("verb", "aux")]
    return "past" if verbs and all(is_over(s, i) for i in verbs) else "command"


def is_over(s: Sentence, i: int) -> bool:
    """Return whether the verb at i describes a past or habitual action, which is not a command."""
    word, is_a = s.words[i], s.lexicon.is_a
    if is_a(word.text, "past") or is_a(word.text, "perfect"):
        return True
    if word.kind != "verb":
        return False
    before = [other.text for other in s.words[max(0, i - 2) : i]]
    if word.text.endswith("ed") and word.text != word.lemma:
        return True
    return bool(before) and (is_a(before[-1], "subject") or any(is_a(text, "perfect") for text in before))


def _asks(s: Sentence) -> bool:
    words = s.words
    start = next(
        (
            i
            for i, word in enumerate(words)
            if s.lexicon.is_a(word.text, "interrogative")
            or word.text in ("there", "here")
            or (word.kind not in _NOT_YET and word.text not in ("robot", "please"))
        ),
        None,
    )
    if start is None:
        return False
    opening = words[start]
    if not s.lexicon.is_a(opening.text, "interrogative"):  # "is it open", "did you see it"; not "be careful"
        return (opening.kind == "aux" and opening.text != "be") or opening.text in ("did", "does")
    verb = next((i for i, word in enumerate(words) if word.kind in ("aux", "modal", "verb")), None)
    if verb is None:
        return True
    if opening.text == "why" and any(word.kind == "neg" for word in words[verb : verb + 3]):
        return False  # "why don't you open the window" is a request
    if opening.text == "when":  # in "when you are there, take the cup" the subject comes first
        return verb == start + 1
    return words[verb].kind != "verb"
