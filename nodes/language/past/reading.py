"""Reads questions about the past: what is asked of what, and for which time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set
from copy import deepcopy
from dataclasses import replace
from datetime import datetime
from itertools import pairwise
from typing import Final, cast, get_args

from semmap.nodes.language.lexicon.past import load
from semmap.nodes.language.past.claims import read_claim
from semmap.nodes.language.past.coverage import find_unused, mark_used
from semmap.nodes.language.past.elements import TENSES, Element, Elements
from semmap.nodes.language.past.question import Anchor, Asked, Order, PastQuestion
from semmap.nodes.language.past.times import Period, TimeReader
from semmap.nodes.language.reference_resolution.map_index import MapIndex
from semmap.schemas.language import Language

_SPEAKER: Final = frozenset(("i", "we", "me", "us", "io", "noi"))
_OF_BOTH: Final = ("change", "missing", "new", "same")
"""Events of questions in the present that are about the past: is anything missing since 10:00."""
_ANCHORS: Final = get_args(Anchor)


def read_questions(
    text: str, known: MapIndex, names: Set[str], now: datetime, languages: Sequence[Language]
) -> tuple[Language, list[PastQuestion]]:
    """Return the questions about the past in a text, in the language that explains most of its words.

    The list is empty if the first question is not about the past. `names` are further names in lower case: of
    authors, and of entities that no longer exist.
    """
    best: tuple[Language, list[PastQuestion]] = languages[0], []
    fewest = 0
    for language in languages:
        lexicon = load(language)
        elements = Elements(lexicon, known.nouns[language], TimeReader(lexicon, now), names)
        found = _read_all(lexicon.split(text), elements)
        unused = sum(len(doubt.split()) for question in found for doubt in question.doubts)
        if found and (not best[1] or unused < fewest):
            best, fewest = (language, found), unused
    return best


def _read_all(words: list[str], elements: Elements) -> list[PastQuestion]:
    found: list[PastQuestion] = []
    part: list[str] = []
    for word in (*words, ";"):
        if word not in ("?", ";"):
            part.append(word)
        elif part:
            for one in _split_questions(elements.read(part)):
                question = _read(one, is_marked=word == "?", before=found)
                if question is not None:
                    found.append(question)
                elif not found:
                    return []
                else:
                    found[-1].doubts.append(_text(one))
            part = []
    return found


def _split_questions(elements: list[Element]) -> Iterator[list[Element]]:
    """Yield the elements of each question: who moved the cup, and when."""
    begin = 0
    for i, (joined, following) in enumerate(pairwise(elements)):
        is_question = any(e.kind == "ask" or e.is_a("mark", *TENSES) for e in elements[begin:i])
        if is_question and joined.is_a("mark", "and") and following.kind == "ask":
            yield elements[begin:i]
            begin = i + 1
    yield elements[begin:]


def _text(elements: Sequence[Element]) -> str:
    return " ".join(element.text for element in elements)


def _read(elements: list[Element], *, is_marked: bool, before: Sequence[PastQuestion]) -> PastQuestion | None:
    """Return the question of some elements, or None if it is not one about the past.

    A question word alone asks it of the same as the question before.
    """
    asks = [element for element in elements if element.kind != "filler"]
    if before and len(asks) == 1 and asks[0].kind == "ask":
        first, claim = before[-1], deepcopy(before[-1].claim)
        return replace(first, text=_text(elements), asked=cast(Asked, asks[0].value), claim=claim)
    is_tag = _drop_tag(elements)
    main, anchor, rest = _split(elements)
    was_it = _drop_cleft(main)
    asked = _asked(main, is_marked=is_marked)
    if asked is None:
        return None
    period = Period()
    for element in elements:
        if element.period is not None:
            combined = period.combined(element.period)
            element.is_used = combined is not None
            period = combined or period
    anchored = read_claim(rest, anchor) if anchor else None
    for element in rest:
        element.is_used = element.is_used or element.is_a("mark", *TENSES, "first", "last", "stay")
    question = PastQuestion(
        _text(elements), asked, read_claim(main, asked), period, anchor=anchor, anchored=anchored
    )
    _add_marks(question, main)
    question.is_negated = question.is_negated and not is_tag
    if was_it is not None:  # was it Anna who moved the cup
        question.asked, question.is_last, question.claim.agent = "whether", True, was_it.text
    _specialise(question, main)
    if not _is_past(question, main):
        return None
    mark_used(question, main)
    question.doubts = find_unused(elements)
    question.unused = [e.text for e in elements if not e.is_used and e.kind not in ("filler", "unknown")]
    return question


def _split(elements: list[Element]) -> tuple[list[Element], Anchor | None, list[Element]]:
    """Return the main clause, and the clause after *before*, *after* or *while*, if there is one."""
    for i, element in enumerate(elements):
        value = element.value if element.kind == "mark" else element.senses.get("mark", "")
        if value == "before" and i + 1 == len(elements):
            element.kind, element.value = "mark", "previously"  # where was it before
        if value not in _ANCHORS or i + 1 == len(elements):
            continue
        has_asked = any(e.kind == "ask" or (e.is_a("mark", *TENSES)) for e in elements[:i])
        if element.kind == "ask" and not has_asked:
            continue
        element.is_used = True
        anchor = cast(Anchor, value)
        if any(e.kind not in ("filler", "time") for e in elements[:i]):
            return elements[:i], anchor, elements[i + 1 :]
        begin = next((k for k, e in enumerate(elements) if k > i and e.kind == "ask"), None)
        if begin is not None:  # before it was moved, where was the cup
            return elements[begin:], anchor, elements[i + 1 : begin]
    return elements, None, []


def _drop_tag(elements: list[Element]) -> bool:
    """Remove *has it* at the end of a statement, and return whether it was there."""
    is_tag = len(elements) > 3 and elements[-2].is_a("mark", *TENSES) and elements[-1].is_a("mark", "it")
    if not is_tag or elements[0].kind != "thing":
        return False
    del elements[-2:]
    return True


def _drop_cleft(main: list[Element]) -> Element | None:
    """Remove *was it Anna* before *who*, and return Anna."""
    if len(main) < 5 or not main[3].is_a("ask", "who") or main[2].kind not in ("thing", "unknown"):
        return None
    if not main[0].is_a("mark", *TENSES) or not main[1].is_a("mark", "it"):
        return None
    main[2].is_used = True
    found = main[2]
    main[:4] = [main[3], main[0]]
    return found


def _asked(main: Sequence[Element], *, is_marked: bool) -> Asked | None:
    """Return what is asked, or None if the clause does not begin as a question about the past does."""
    if any(e.text in _SPEAKER for e in main):
        return None  # where did I put it: who speaks is not known
    begin = [e for e in main if e.kind not in ("filler", "time")]
    is_told = bool(begin) and begin[0].is_a("mark", "telling")
    words = [e for e in begin if not e.is_a("mark", "telling")]
    ask = next((e for e in words if e.kind == "ask"), None)
    if ask is not None:
        before = words[: words.index(ask)]
        if any(e.kind in ("event", "unknown") for e in before):
            return None
        if ask.value not in ("how_long", "changed") and any(e.is_a("mark", *TENSES) for e in before):
            return None
        if ask.value == "when" and not is_told and not _is_direct(words, words.index(ask)):
            return None
        ask.is_used = True
        return cast(Asked, ask.value)
    if any(e.kind == "unknown" for e in words):
        return None
    if words and words[0].is_a("mark", "anything") and any(e.is_a("event", "change", "new") for e in words):
        return "whether"  # anything different on the table
    if not any(e.is_a("mark", *TENSES) for e in words):
        return None
    if words[0].text == "have" and not any(e.text == "been" for e in words):
        return None  # have Robin follow you
    if main[0].kind == "time" and not is_marked:
        return None  # this morning was nice
    is_question = is_marked or any(e.is_a("mark", "ever", "never") for e in words)
    is_first = words[0].is_a("mark", *TENSES) or is_told
    return "whether" if is_first or (is_question and words[0].kind != "event") else None


def _is_direct(words: Sequence[Element], i: int) -> bool:
    """Return whether *when* asks, and does not begin a condition: when you are there, take the cup."""
    following = next((e for e in words[i + 1 :] if not e.is_a("mark", "last", "first")), None)
    if following is not None and following.is_a("mark", *TENSES):
        return True
    return words[i].text.startswith("quand") and any(e.is_a("mark", "past", "perfect") for e in words)


def _add_marks(question: PastQuestion, main: Sequence[Element]) -> None:
    """Read the order, the tense and the negation of a question."""
    marks = {e.value for e in main if e.kind == "mark"}
    question.order = cast(Order, next((order for order in ("last", "first") if order in marks), ""))
    last = next((e.value for e in reversed(main) if e.is_a("mark", *TENSES) and e.text != "been"), "")
    question.is_current = last in ("present", "perfect")
    question.is_negated = bool(marks & {"never", "not", "no_one"})
    question.is_repeated = "more_than_once" in marks
    question.is_last = bool(marks & {"or_else", "last"})
    question.is_previous = "previously" in marks


def _specialise(question: PastQuestion, main: Sequence[Element]) -> None:
    """Change what is asked by the event: *what was missing*, *which room was it in*."""
    claim = question.claim
    has_trailing = [e for e in main if e.kind == "mark" and e.value.startswith("trailing ")]
    marks = {e.value for e in main if e.kind == "mark"}
    if question.asked == "whether" and claim.event == "same":
        question.asked, question.is_all = "changed", True
        claim.places += [("at", text) for text in claim.subjects]
        claim.subjects, claim.is_it = [], False
        question.period = _since_then(question.period)
    elif question.asked == "whether" and "everything" in marks and "still" in marks and claim.places:
        question.asked, question.is_all = "missing", True
        question.period = _since_then(question.period)
    elif question.asked == "how_long" and any(e.text.startswith("for long") for e in main):
        question.order = "last"
    elif question.asked == "how_long" and claim.state and "stay" in marks and "did" in [e.text for e in main]:
        question.order = question.order or "last"  # how long did it stay open
    elif question.asked in ("what", "whether") and claim.event == "change" and not claim.agent:
        question.asked = "changed"
    elif question.asked in ("what", "whether", "missing") and _is_missing(question, main):
        question.asked = "missing"
        if question.is_current:  # what was there at 10:00 is not anymore
            question.period = _since_then(question.period)
    elif question.asked == "what" and (claim.kind or (has_trailing and claim.subjects)):
        question.asked = "where"  # what was the cup on, which rooms did it visit
    elif question.asked == "where" and has_trailing and has_trailing[0].value == "trailing from":
        claim.places.append(("from", ""))
    question.is_gross = any("happen" in e.text or "success" in e.text for e in main)
    if question.asked == "changed":
        about = [text for how, text in claim.places if how in ("to", "by")]
        claim.places = [(how, text) for how, text in claim.places if how not in ("to", "by")]
        claim.subjects += about


def _since_then(period: Period) -> Period:
    """Return the period from a moment until now."""
    return period if period.at is None else Period(since=period.at)


def _is_missing(question: PastQuestion, main: Sequence[Element]) -> bool:
    """Return whether a question asks what is no longer at a place: is gone, disappeared, is not there."""
    claim = question.claim
    if question.asked == "whether" and claim.subjects and not question.is_current:
        return False  # was the cup missing
    is_gone = claim.event == "remove" and not claim.agent and any(how == "from" for how, _ in claim.places)
    is_not_there = question.is_negated and any(e.is_a("mark", "there") for e in main)
    return claim.event == "missing" or is_gone or (question.asked == "what" and is_not_there)


def _is_past(question: PastQuestion, main: Sequence[Element]) -> bool:
    """Return whether a question is about the past, and not about the present."""
    claim, asked = question.claim, question.asked
    tenses = {e.value for e in main if e.is_a("mark", *TENSES)}
    is_past = bool(tenses & {"past", "perfect"})
    has_period = question.period != Period() or question.anchor is not None
    has_claim = bool(claim.event or claim.state or claim.places or claim.is_there)
    about = bool(claim.subjects or claim.is_it or claim.is_anyone or claim.is_anything)
    if asked == "changed":
        return True
    if asked == "missing":
        is_denied = any(e.text.startswith(("no ", "not ")) for e in main)
        return is_past or has_period or is_denied or bool(claim.places)
    if asked in ("since", "until"):
        return has_claim
    if asked in ("how_often",):
        return has_claim and (is_past or has_period)
    if asked == "how_long":
        return has_claim and (is_past or bool(claim.state) or _asks_duration(main))
    if asked == "where":
        return is_past and about
    if not is_past and not any(e.kind == "event" for e in main):
        return False
    if asked == "whether" and not is_past:
        return claim.event in _OF_BOTH
    is_told = any(e.is_a("mark", "telling") for e in main)
    if not tenses and not is_told and asked not in ("who", "what", "how_many"):
        return False
    if asked in ("what", "how_many", "who") and not is_past and "present" in tenses:
        return claim.event in ("new", "missing")
    return has_claim and (is_past or bool(claim.event))


def _asks_duration(main: Sequence[Element]) -> bool:
    """Return whether *how long* is not about a length: for how long is it there, da quanto sta lì."""
    return any(e.kind == "ask" and e.text.startswith(("for ", "da ", "per ", "è ")) for e in main)
