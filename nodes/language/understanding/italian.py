"""Translates Italian word by word to English, with clitics and articles separated."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

from semmap.nodes.language.lexicon.italian import ARTICULATED, Italian, italian, singulars
from semmap.nodes.language.understanding.gloss import Gloss, Glossed
from semmap.nodes.language.understanding.grounding import Scene
from semmap.nodes.language.vocabulary import to_words
from semmap.nodes.language.words import PartOfSpeech, plain

_WORD: Final = re.compile(r"[^\W\d_]+'(?=\w)|po'|\d+(?:[.,:]\d+)?|[^\W_]+(?:-[^\W_]+)*")
_IS: Final = re.compile(r"(?<!\w)e'(?!\w)")  # è, typed without the accent key
_IMPERATIVE: Final = re.compile(r"(?<!\w)(d[ai])'(?!\w)", re.IGNORECASE)  # di' and da' are also dì and dà
_LONGEST: Final = 5  # words of an expression or a label
_FIRST: Final = ("me", "te", "ce", "ve", "glie", "se")
_SECOND: Final = ("lo", "la", "li", "le", "ne")
_CLITICS: Final = {
    **{first + second: (first, second) for first in _FIRST for second in _SECOND},
    **{one: (one,) for one in ("mi", "ti", "ci", "vi", *_SECOND, "gli", "si")},
}
_SHORT: Final = ("da", "va", "fa", "sta", "di")  # these double the consonant of a clitic: dammi
_DETERMINERS: Final = ("the", "a", "this", "that", "my", "your", "his", "our", "their", "some", "no", "every")
_POSSESSIVES: Final = ("my", "your", "his", "our", "their")
_PLURAL: Final = ("i", "gli", "le")
_GIVING: Final = ("give", "hand", "offer")
_INFINITIVE: Final = ("are", "ere", "ire")
_AFTER_GIVING: Final = ("the", "a", "this", "that", "some", "to")
_NUMBERS: Final = (
    *("two", "three", "four", "five", "seven", "eight", "nine", "ten"),
    *("eleven", "twelve", "thirty", "ninety"),
)
_ENDING: Final = ("and", "then", "please", "to", "from", "in", "on", "with", "near", "for", "here", "there")
_OPENING: Final = (
    *("and", "or", "but", "then", "please", "robot", "sorry", "hey", "hello", "you", "not", "to", "okay"),
    *("would", "should", "while", "thanks", "now", "tomorrow", "morning", "evening", "tonight", "later"),
    *("afternoon", "night", "day", "minutes", "seconds", "hours", "otherwise", "so"),
)  # a clause begins after these


def normalise(text: str) -> str:
    """Return a text with uniform apostrophes and accents."""
    text = _IS.sub("è", text.replace("’", "'"))
    return _IMPERATIVE.sub(lambda found: found[1][0] + ("ì" if found[1][1] in "iI" else "à"), text)


def split(text: str) -> list[str]:
    """Return the words of a text in lower case; `portamela` becomes `porta me la`."""
    return [token.removeprefix("-") for token in _tokens(text)]


def gloss(text: str, scene: Scene) -> Gloss:
    """Return a sentence with its English words; nouns are labels of entities and classes."""
    tokens = _tokens(text)
    words = _Glossing(tokens, scene, italian()).words()
    return Gloss(tuple(token.removeprefix("-") for token in tokens), tuple(words))


def share(text: str) -> int:
    """Return the number of words of a text that are in the Italian lexicon."""
    known = italian()
    return sum(token.startswith("-") or known.is_word(token) for token in _tokens(text))


def _tokens(text: str) -> list[str]:
    """Return the words; clitics at the end of a verb are separate and begin with `-`."""
    known = italian()
    found: list[str] = []
    words = _WORD.findall(normalise(plain(text)))
    for k, word in enumerate(words):
        following = words[k + 1] if k + 1 < len(words) else ""
        previous = found[-1] if found else ""
        nominal = previous in ARTICULATED or known.expressions.get((previous,), "") in _DETERMINERS
        opens = not found or previous == "favore" or known.expressions.get((previous,), "") in _OPENING
        first = ARTICULATED.get(following, (following,))[0]
        opens = opens or known.expressions.get((first,), "") in _AFTER_GIVING  # "dalle il latte"
        apart = None if nominal and not previous.startswith("-") else _parted(word, opens, known)
        found += [word] if apart is None else [apart[0], *(f"-{clitic}" for clitic in apart[1])]
    return found


def _parted(word: str, opens: bool, known: Italian) -> tuple[str, tuple[str, ...]] | None:
    """Split a verb and the clitics at its end; None for other words."""
    if known.is_word(word) and not (opens and word in ARTICULATED):
        return None
    for ending, clitics in sorted(_CLITICS.items(), key=lambda item: -len(item[0])):
        stem = word.removesuffix(ending)
        if stem != word and stem in known.verbs:
            return stem, clitics
        if stem[:-1] in _SHORT and stem != word and stem[-1] == ending[0]:
            return stem[:-1], clitics
    return None


class _Piece(NamedTuple):
    """A word, or a part of an articulated preposition; `token` is the index of the word."""

    text: str
    token: int
    is_clitic: bool = False


class _Glossing:
    """Translates the pieces from left to right."""

    def __init__(self, tokens: Sequence[str], scene: Scene, known: Italian) -> None:
        self._tokens, self._scene, self._known = tokens, scene, known
        self._pieces = list(self._pieced())
        self._found: list[Glossed] = []
        self._before_verb: list[Glossed] = []  # clitics that follow the verb in English

    def words(self) -> list[Glossed]:
        """The English words."""
        i = 0
        while i < len(self._pieces):
            i += self._read(i)
        return self._found + self._before_verb

    def _pieced(self) -> Iterator[_Piece]:
        for n, token in enumerate(self._tokens):
            if token.startswith("-"):
                yield _Piece(token[1:], n, True)
            elif token in ARTICULATED and not self._gives(n):
                yield from (_Piece(part, n) for part in ARTICULATED[token])
            else:
                yield _Piece(token, n)

    def _gives(self, n: int) -> bool:
        """Return whether a word is `dai` (give) and not `da i` (from the): no noun follows, but `a Nora`."""
        following = self._tokens[n + 1] if n + 1 < len(self._tokens) else ""
        first = ARTICULATED.get(following, (following,))[0]
        begins = self._known.expressions.get((first,), "") in (*_DETERMINERS, "to")
        return self._tokens[n] in self._known.verbs and (following.startswith("-") or begins)

    def _read(self, i: int) -> int:
        """Translate the next words. Returns the number of pieces."""
        piece = self._pieces[i]
        if piece.is_clitic:
            self._clitic(i)
            return 1
        if self._is_verb(i):
            self._say(self._known.verbs[piece.text], i, i, "verb")
            self._found += self._before_verb
            self._before_verb = []
            return 1
        for length in range(min(_LONGEST, len(self._tokens) - piece.token), 1, -1):
            if (name := self._called(i, length)) is not None:
                return self._noun(name, i, length)
        if self._counts(i) and (name := self._called(i, 1)) is not None and self._ends_group(i + 1):
            return self._noun(name, i, 1)  # Otto, but "otto tazze"
        if self._stands_before_verb(i):
            self._clitic(i)
            return 1
        english = self._known.adjectives.get(piece.text)
        if english and self._follows("noun") and not self._begins_expression(i):
            self._adjective(english, i)
            return 1
        for length in range(min(_LONGEST + 2, len(self._pieces) - i), 0, -1):
            words = tuple(p.text for p in self._pieces[i : i + length])
            than = self._known.expressions.get(words, "").endswith(" than")
            if words[-1] == "di" and not than and self._counts(i + length):  # "a sinistra di 90 gradi"
                if length == 1:
                    self._say("by", i, i, "prep")
                    return 1
            elif words in self._known.expressions:
                return self._expression(self._known.expressions[words], i, length)
        if piece.text in self._known.relative:
            self._say(self._known.relative[piece.text], i, i, "rel")
        elif english:
            self._say(english, i, i, "noun" if self._ends(i) and self._follows("det") else "adj")
        elif (name := self._called(i, 1)) is not None:
            self._noun(name, i, 1)
        else:
            self._say(piece.text, i, i, None)
        return 1

    def _say(self, english: str, first: int, last: int, kind: PartOfSpeech | None) -> None:
        """Add English words for pieces; words in parentheses have no original."""
        start, end = self._pieces[first].token + 1, self._pieces[last].token + 1
        for word in english.split():
            if word.startswith("("):
                self._found.append(Glossed(word.strip("()"), 1, 0, end))
            else:
                is_plural = kind == "det" and self._pieces[last].text in _PLURAL
                self._found.append(Glossed(word, start, end, end, kind, is_plural))

    def _expression(self, english: str, i: int, length: int) -> int:
        following = self._pieces[i + 1].text if i + 1 < len(self._pieces) else ""
        if english == "of" and self._is_infinitive(i + 1):
            english = "to"  # "chiedi a Nora di venire"
        if english == "of" and self._is_partitive(i):
            self._say("some", i, i + 1, "det")
            return 2
        if english == "of" and self._is_compound(i):  # "il tavolo della cucina" is the kitchen table
            return 2 + self._compound(i + 2)
        if english == "the" and self._known.expressions.get((following,)) in _POSSESSIVES:
            self._say(self._known.expressions[(following,)], i, i + 1, "det")
            return 2
        if english == "all" and self._pieces[i].text == "tutto" and not self._is_determiner(following):
            self._say("everything", i, i, "pron")
            return 1
        if english == "never" and any(word.text == "not" for word in self._found):
            return length  # "non toccare mai" has one negation
        if english == "a" and self._ends(i):
            self._say("one", i, i, "pron")
            return 1
        self._say(english, i, i + length - 1, "det" if english in _DETERMINERS else None)
        return length

    def _is_infinitive(self, i: int) -> bool:
        """Return whether piece i is an infinitive, also without its last letter: portare, portar-mi."""
        text = self._pieces[i].text if i < len(self._pieces) else ""
        if i + 1 < len(self._pieces) and self._pieces[i + 1].is_clitic:
            text = f"{text}e"
        return text.endswith(_INFINITIVE) and self._pieces[i].text in self._known.verbs

    def _is_determiner(self, text: str) -> bool:
        return self._known.expressions.get((text,), "") in _DETERMINERS

    def _counts(self, i: int) -> bool:
        """Return whether piece i is a number."""
        text = self._pieces[i].text if i < len(self._pieces) else ""
        return text[:1].isdigit() or self._known.expressions.get((text,), "") in _NUMBERS

    def _ends_group(self, i: int) -> bool:
        """Return whether no noun or adjective begins at piece i."""
        if i >= len(self._pieces):
            return True
        return self._pieces[i].text not in self._known.adjectives and self._called(i, 1) is None

    def _is_partitive(self, i: int) -> bool:
        """Return whether `di` and an article begin an object: `prendi del latte`."""
        joined = i + 1 < len(self._pieces) and self._pieces[i].token == self._pieces[i + 1].token
        before = self._found[-1] if self._found else None
        return joined and (
            before is None
            or (before.kind in ("verb", "pron") and before.text != "one")
            or before.text in ("like", "need", "is", "are", "want", "please", "there")
        )

    def _is_compound(self, i: int) -> bool:
        """Return whether `di` and an article are between two nouns."""
        joined = i + 2 < len(self._pieces) and self._pieces[i].token == self._pieces[i + 1].token
        return joined and self._follows("noun") and self._called(i + 2, 1) is not None

    def _compound(self, i: int) -> int:
        """Add a modifying noun before the noun that it modifies. Returns the number of pieces."""
        lengths = range(min(_LONGEST, len(self._tokens) - self._pieces[i].token), 0, -1)
        length = next(n for n in lengths if self._called(i, n) is not None)
        pieces = self._noun(self._called(i, length) or "", i, length)
        self._found[-2:] = reversed(self._found[-2:])
        return pieces

    def _noun(self, name: str, i: int, length: int) -> int:
        first = self._pieces[i].token
        self._found.append(Glossed(name, first + 1, first + length, first + 1, "noun"))
        pieces = [piece for piece in self._pieces[i:] if piece.token < first + length]
        return len(pieces)

    def _adjective(self, english: str, i: int) -> None:
        """Add an adjective before its noun."""
        token = self._pieces[i].token + 1
        self._found.insert(len(self._found) - 1, Glossed(english, token, token, token, "adj"))

    def _clitic(self, i: int) -> None:
        text, token = self._pieces[i].text, self._pieces[i].token + 1
        verb = next((word for word in reversed(self._found) if word.kind == "verb"), None)
        behind = verb is not None and self._pieces[i].is_clitic
        moves = behind and verb is not None and self._tokens[verb.first - 1] in self._known.moving
        english = self._known.clitics[text]
        if moves and text in ("ti", "ci", "si"):
            english = "there" if text == "ci" else ""
        elif text == "le" and verb is not None and verb.text in _GIVING and not self._ends(i):
            english = "her"
        if english:
            kind: PartOfSpeech = "adv" if english == "there" else "pron"
            (self._found if behind else self._before_verb).append(Glossed(english, token, token, token, kind))

    def _stands_before_verb(self, i: int) -> bool:
        """Return whether piece i is a clitic before its verb: `mi porti`, `lo prendi`; not `si trova`."""
        if self._pieces[i].text not in self._known.clitics or self._begins_expression(i):
            return False
        j = i + 1
        while j < len(self._pieces) and self._pieces[j].text in self._known.clitics and j < i + 2:
            j += 1
        is_article = (self._pieces[i].text,) in self._known.expressions
        return (
            j < len(self._pieces)
            and self._pieces[j].text in self._known.verbs
            and not (is_article and self._called(j, 1) is not None)
            and not (i > 0 and self._pieces[i - 1].token == self._pieces[i].token)
        )

    def _is_verb(self, i: int) -> bool:
        """Return whether piece i is a verb, and not a noun or preposition with the same spelling."""
        text = self._pieces[i].text
        if text not in self._known.verbs or (i and self._pieces[i - 1].token == self._pieces[i].token):
            return False
        before = self._found[-1] if self._found else None
        opens = before is None or bool(self._before_verb) or before.text in _OPENING or self._follows_hour()
        following = self._pieces[i + 1] if i + 1 < len(self._pieces) else None
        if following is not None and following.is_clitic:  # "se è freddo portalo"
            return True
        takes = following is not None and (
            self._known.expressions.get((following.text,)) in _DETERMINERS or following.text == "di"
        )
        is_noun = self._called(i, 1) is not None
        if before is not None and (before.kind == "det" or (before.kind == "adj" and is_noun and not takes)):
            return False
        if (text,) in self._known.expressions:  # "da", "sei"
            return False
        if text.endswith((*_INFINITIVE, "r")):
            return True
        is_after_preposition = (
            before is not None and before.kind != "adj" and before.text in ("in", "of", "from", "on")
        )
        if is_noun or is_after_preposition:  # "se è freddo porta la tazza"
            return opens or (takes and before is not None and before.kind in ("noun", "adj", "verb", None))
        return True

    def _follows_hour(self) -> bool:
        """Return whether the last words are an hour: `alle dieci`."""
        words = [word.text for word in self._found[-3:]]
        return words[:2] == ["to", "the"] and (words[-1] in _NUMBERS or words[-1][:1].isdigit())

    def _follows(self, kind: PartOfSpeech) -> bool:
        return bool(self._found) and self._found[-1].kind == kind

    def _begins_expression(self, i: int) -> bool:
        """Return whether an expression of several words begins at piece i: `prima di`, `si trova`."""
        texts = tuple(piece.text for piece in self._pieces[i : i + _LONGEST + 2])
        return any(texts[:length] in self._known.expressions for length in range(2, len(texts) + 1))

    def _ends(self, i: int) -> bool:
        """Return whether the noun phrase ends at piece i."""
        if i + 1 == len(self._pieces):
            return True
        following = self._pieces[i + 1]
        english = self._known.expressions.get((following.text,), "")
        return (
            english in _ENDING
            or following.is_clitic
            or (following.text in self._known.verbs and self._called(i + 1, 1) is None)
        )

    def _called(self, i: int, length: int) -> str | None:
        """Return the label that the words from piece i on denote, or None."""
        token = self._pieces[i].token
        if i and self._pieces[i - 1].token == token:
            return None
        words = self._tokens[token : token + length]
        if any(word.startswith("-") for word in words):
            return None
        rest = " ".join(["", *words[1:]]).replace("' ", "'")
        for first in singulars(words[0]):
            text = first + rest
            if text in self._scene.by_label:
                return text
            name = self._scene.vocabulary.class_of(text) or self._known.synonyms.get(text)
            if name is not None:
                return to_words(name)
        return None
