"""Commands in Italian as English words that keep their place in the Italian text."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Final

from semmap.nodes.language.lexicon.commands import load as grammar
from semmap.nodes.language.lexicon.italian import italian as lexicon
from semmap.nodes.language.steps.tokens import Text, Token, correction_length
from semmap.nodes.language.understanding import italian
from semmap.nodes.language.understanding.grounding import Scene
from semmap.nodes.language.words import without_markup

_ADJECTIVES: Final = frozenset(lexicon().adjectives.values())
_ARTICLES: Final = frozenset(("the", "these", "a", "this", "that", "and", "from", "on", "in", ",", "."))
_BEFORE_GROUP: Final = _ARTICLES | {"is", "are"}
_BEFORE_HOUR: Final = frozenset(("a", "half", "quarter", "of"))
_SOUND: Final = r"(?:ehm|uhm|um|mmm?|eh|ah|oh|beh|boh)"
_HESITATION: Final = re.compile(
    rf"(?:,\s*)?(?<!\w){_SOUND}(?!\w)(?:\s*,?\s*{_SOUND}(?!\w))*(?:\s*,)?", re.IGNORECASE
)
_WORD: Final = re.compile(r"\s*(\w+)")
_MARK: Final = re.compile(r"(?<!\d)[.,:]|[.,:](?!\d)|[;!?]")


def translate(text: str, scene: Scene) -> Text:
    """Return the English words of an Italian command; nouns are labels of the entities in `scene`.

    Each part between punctuation marks is translated word by word. A word has the place of the Italian words
    that it stands for.
    """
    plain = italian.normalise(without_markup(text))
    fluent = _without_hesitation(plain)
    tokens: list[Token] = []
    start = 0
    for mark in _MARK.finditer(fluent):
        tokens += _translated(fluent, start, mark.start(), scene)
        tokens.append(Token(mark[0], mark.start(), mark.end()))
        start = mark.end()
    tokens += _translated(fluent, start, len(fluent), scene)
    tokens = _with_predicates(_with_superlatives(_with_times(tokens)), plain)
    return Text(plain, tokens, tuple(token.word for token in tokens), is_translated=True)


def _without_hesitation(text: str) -> str:
    """Return a text of the same length with spaces for sounds such as *ehm* and the commas around one.

    Before a verb or a correction one comma is left, since it may be all that separates it from the rest.
    """

    def blank(found: re.Match[str]) -> str:
        following = _WORD.match(text, found.end())
        words = italian.split(following[1]) if following is not None else []
        is_verb = bool(words) and words[0] in lexicon().verbs and "," in found[0]
        is_apart = is_verb or _begins_correction(text[found.end() :])
        return ("," if is_apart and found.start() > 0 else " ").ljust(len(found[0]))

    return _HESITATION.sub(blank, text)


def _begins_correction(text: str) -> bool:
    """Return whether an Italian text begins with an expression of correction: no, scusa, anzi."""
    words = italian.split(text)[:3]
    texts = (
        lexicon().expressions.get(tuple(words[:k]), " ".join(words[:k])) for k in range(1, len(words) + 1)
    )
    return any(correction_length(english.split()) == len(english.split()) for english in texts)


def _with_times(tokens: list[Token]) -> list[Token]:
    """Replace words of times: *tra cinque minuti* is in five minutes, *ora* now or an hour."""
    found: list[Token] = []
    for token in tokens:
        before = [other.word for other in found[-2:]]
        if token.word == "now" and before[-1:] in (["a"], ["half"], ["of"]):
            token = replace(token, word="hour")
            first = next((k for k in range(len(found) - 1, -1, -1) if found[k].word not in _BEFORE_HOUR), -1)
            if first >= 0 and found[first].word == "between":
                found[first] = replace(found[first], word="in")
        if grammar().number(token.word) is not None or ":" in token.word:
            if before[-1:] == ["between"]:
                found[-1] = replace(found[-1], word="in")
            elif before in (["to", "these"], ["to", "the"]):
                found[-2:] = [replace(found[-2], word="at")]
        found.append(token)
    return found


def _with_superlatives(tokens: list[Token]) -> list[Token]:
    """Replace *more* and an adjective by a superlative before the noun: *il cuscino più grande*."""
    found: list[Token] = []
    i = 0
    while i < len(tokens):
        adjective = tokens[i + 1].word if i + 1 < len(tokens) else ""
        if tokens[i].word == "most" and adjective in _ADJECTIVES:
            word = replace(tokens[i], word=_superlative(adjective), end=tokens[i + 1].end)
            k = len(found)
            while k and found[k - 1].first < found[k - 1].end and found[k - 1].word not in _BEFORE_GROUP:
                k -= 1
            found.insert(k, word)
            i += 2
        else:
            is_end = tokens[i].word == "most" and any(token.word == "not" for token in found)
            found.append(replace(tokens[i], word="anymore") if is_end else tokens[i])  # non seguirmi più
            i += 1
    return found


def _with_predicates(tokens: list[Token], text: str) -> list[Token]:
    """Move the adjective of a question behind its subject: *è aperto il frigo* is *is the fridge open*.

    *Non è* in a question is *is not*.
    """
    found = list(tokens)
    for i, token in enumerate(found[:-1]):
        following = found[i + 1]
        mark = next((one.word for one in found[i:] if one.word in ".;!?"), "")
        if token.word == "not" and following.word in ("is", "are") and mark == "?":
            found[i : i + 2] = [following, token]
    tokens = list(found)
    for i, token in enumerate(tokens[:-2]):
        adjective, article = tokens[i + 1], tokens[i + 2]
        said = text[adjective.first : adjective.end].lower()
        is_first = i == 0 or tokens[i - 1].word in ",.;:!?"
        if (
            is_first
            and token.word in ("is", "are")
            and lexicon().adjectives.get(said) == adjective.word
            and grammar().match("determiner", [article.word], 0)
        ):
            end = next((k for k in range(i + 2, len(tokens)) if _ends_subject(tokens, k)), len(tokens))
            found[i + 1 : end] = [*tokens[i + 2 : end], adjective]
    return found


def _ends_subject(tokens: list[Token], k: int) -> bool:
    """Return whether the subject of a question ends at `k`: before a mark, or *and* with an adjective."""
    following = tokens[k + 1].word if k + 1 < len(tokens) else ""
    return tokens[k].word in ",.;:!?" or (tokens[k].word in ("and", "or") and following in _ADJECTIVES)


def _superlative(adjective: str) -> str:
    if adjective.endswith("y"):
        return f"{adjective[:-1]}iest"
    is_short = len(adjective) == 3 and adjective[1] in "aeiou"
    return f"{adjective}{adjective[-1] if is_short else ''}est".replace("eest", "est")


def _translated(text: str, start: int, end: int, scene: Scene) -> Iterator[Token]:
    """Yield the English words of a part of the text."""
    gloss = italian.gloss(text[start:end], scene)
    spans: list[tuple[int, int]] = []
    lower, i = text.lower(), start
    for word in gloss.original:
        i = lower.index(word, i)
        spans.append((i, i + len(word)))
        i += len(word)
    for glossed in gloss.words:
        is_inserted = glossed.first > glossed.last
        first, last = (end, end) if is_inserted else (spans[glossed.first - 1][0], spans[glossed.last - 1][1])
        is_plural = glossed.is_plural and glossed.text == "the"
        is_capital = not is_inserted and text[first].isupper() and first > start
        is_name = is_capital and grammar().number(glossed.text) is not None  # Otto, and not otto
        english = text[first:last].lower() if is_name else glossed.text
        for word in ("these",) if is_plural else english.split():
            yield Token(word, first, last, is_capital)
