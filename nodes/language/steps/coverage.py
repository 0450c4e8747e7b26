"""Which words of a text its clauses use: no word may be lost without a sign."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Final

from semmap.nodes.language.lexicon.commands import Grammar
from semmap.nodes.language.steps import tokens
from semmap.nodes.language.steps.clause import Clause, Parsed
from semmap.nodes.language.steps.phrase import NounPhrase
from semmap.nodes.language.steps.tokens import Text

_WITHOUT_CONTENT: Final = (
    *("polite", "then", "and", "determiner", "be", "modal", "have", "relative", "robot", "speaker"),
    *("negation", "phase", "loose_particle", "stated", "of", "to", "pronoun", "wish", "attention", "place"),
    *("all", "exclude", "after_auxiliary", "correction", "weak_correction", "anaphoric", "question", "about"),
)
"""Classes of expressions that the steps do not have to repeat: they state structure, or nothing."""
_QUOTED: Final = re.compile(r"'([^']+(?:'\w[^']*)*)'")


def find_unused(text: Text, grammar: Grammar, parsed: Parsed, doubts: Iterable[str]) -> list[str]:
    """Return the texts of words that are in no role, verb, condition or time, and that no doubt names."""
    used = [text.is_mark(i) for i in range(len(text.words))]
    for first, end in _spans(parsed):
        used[first:end] = [True] * (end - first)
    for i in parsed.structural:
        used[i] = True
    named = [*parsed.unused, *parsed.unknown]
    for clause in parsed.clauses:
        named += (*clause.conditions, *clause.times)
        _mark_verb(text, clause, used)
    for doubt in doubts:
        named += _QUOTED.findall(doubt)
    for corrected in parsed.corrected:
        named += corrected
    for one in filter(None, named):
        _mark(text, one, used)
    i = 0
    while i < len(used):
        length = max(grammar.match(kind, text.words, i) for kind in _WITHOUT_CONTENT)
        used[i : i + length] = [True] * length
        i += length or 1
    return list(_runs(text, used))


def _spans(parsed: Parsed) -> Iterator[tuple[int, int]]:
    """Yield the first word of each phrase and role, and the one after its last."""
    for clause in parsed.clauses:
        for role in clause.roles:
            yield role.first, role.end
            for phrase in role.phrases:
                yield from _phrase_spans(phrase)
    for _, phrase in parsed.context:
        yield phrase.first, phrase.end


def _phrase_spans(phrase: NounPhrase) -> Iterator[tuple[int, int]]:
    yield phrase.first, phrase.end
    for place in phrase.places:
        yield place.first, place.end
        yield from _phrase_spans(place.other)
    others = (phrase.of, phrase.owner, phrase.second, *phrase.excluded, *phrase.alternatives)
    for other in others:
        if other is not None:
            yield from _phrase_spans(other)


def _mark_verb(text: Text, clause: Clause, used: list[bool]) -> None:
    """Mark the words of the verb of a clause as used; its particle may be apart: pick the cup UP."""
    i = clause.first
    for word in tokens.read(clause.verb).words:
        at = next((k for k in range(i, len(used)) if text.words[k] == word), None)
        if at is not None:
            used[at] = True
            i = at + 1
    used[clause.first] = True  # a verb that was translated


def _mark(text: Text, part: str, used: list[bool]) -> None:
    """Mark the words of a part of the text as used, wherever it is."""
    plain, part = text.text.lower(), part.lower()
    at = plain.find(part)
    while at >= 0:
        for i, token in enumerate(text.tokens):
            used[i] = used[i] or (at <= token.first and token.end <= at + len(part))
        at = plain.find(part, at + 1)


def _runs(text: Text, used: list[bool]) -> Iterator[str]:
    """Yield the texts of words in a row that are not used."""
    start = None
    for i, is_used in enumerate([*used, True]):
        if not is_used and start is None:
            start = i
        elif is_used and start is not None:
            if run := text.between(start, i):
                yield run
            start = None
