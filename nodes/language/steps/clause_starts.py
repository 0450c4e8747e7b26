"""Where the clauses of a command begin."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

from semmap.nodes.language.lexicon.commands import Grammar
from semmap.nodes.language.reference_resolution.map_index import Nouns
from semmap.nodes.language.steps.clause import Parsed
from semmap.nodes.language.steps.noun_phrase import NounPhraseReader
from semmap.nodes.language.steps.phrase import NounPhrase
from semmap.nodes.language.steps.times import starts_time
from semmap.nodes.language.steps.tokens import Text

_BEFORE_ELSE: Final = frozenset(
    (
        *(
            "what",
            "who",
            "where",
            "how",
            "anywhere",
            "somewhere",
            "everywhere",
            "nowhere",
            "nothing",
            "nobody",
        ),
        *(start + end for start in ("some", "any", "every") for end in ("one", "body", "thing")),
    )
)
"""Words to which *else* belongs: someone else."""
_BEFORE_OTHERWISE: Final = frozenset(("told", "say", "says", "said", "instructed", "stated"))
"""Verbs to which *otherwise* and *so* belong: unless told otherwise."""
_BEFORE_QUESTION: Final = frozenset(
    (
        *(",", ".", "?", "!", ";", "and", "then", "also", "so", "but"),
        *("robot", "please", "hey", "hello", "hi", "okay", "ok", "know", "idea"),
    )
)
"""Words and marks after which a question may begin."""


class ClauseStarts:
    """Finds where clauses begin in one text; the readers of clauses extend it."""

    def __init__(self, text: Text, grammar: Grammar, nouns: Nouns, is_person: Callable[[NounPhrase], bool],
                 above: Mapping[str, frozenset[str]]) -> None:  # fmt: skip
        """Read clauses of `text`. `is_person` tells whether a phrase denotes a person."""
        self._t, self._g, self._words = text, grammar, text.words
        self._is_person = is_person
        self._np = NounPhraseReader(text, grammar, nouns, self.starts_clause, is_person, above)
        self._nouns, self._above = nouns, above
        self.found = Parsed()
        self._is_negated = False
        """Whether the clause that is read is negated."""
        self._ending: set[str] = set()
        """Conditions that are over when the clause after theirs begins: until she stops."""
        self._unused = 0
        """The number of unused texts before the sentence."""
        self._denied: set[str] = set()
        """Conditions that state that one before does not hold: otherwise."""

    def starts_clause(self, i: int) -> bool:
        """Return whether a new clause begins at `i`, possibly after *and then*."""
        g, words = self._g, self._words
        j = i
        while j < len(words) and (
            length := 1 if words[j] == "," else max(self._then(j), g.match("polite", words, j))
        ):
            if words[j] == "you" or g.verb(words, j)[0] >= length:
                break
            j += length
        if j > i and not self._t.is_mark(j + starts_time(g, words, j)):
            j += starts_time(g, words, j)  # and in ten minutes close it
        if j > i and self._is_infinitive(j):  # and then to follow Anna
            return True
        if self._t.is_mark(j):
            return True
        if self._wish(j):
            return True
        if self._asks_state(j):
            return False
        if (
            (g.match("negation", words, j) and not self._excludes(j))
            or self._phase(j)
            or g.match("condition", words, j)
            or self._anaphoric(j)
            or self._found_at(j)
            or self._asks(j)
        ):
            return True
        manner = g.match("manner", words, j) or int(j < len(words) and words[j].endswith("ly"))
        if manner and j > i and g.verb(words, j + manner)[0]:
            return True  # and carefully take it
        length, _ = g.verb(words, j)
        if self._lets_know(j) > 0 or (g.is_a(words[j], "untaught") and not self._np.is_known(j, j + 1)):
            return True
        if not length or self._is_gerund(j):
            return False
        if length > 1:
            return True
        following = words[j + 1] if j + 1 < len(words) else ""
        if self._np.is_known(j, j + 1) and not self._opens_phrase(j + 1):
            return False
        return following not in ("of", "is", "are", "'s")

    def _asks_state(self, i: int) -> bool:
        """Return whether a last word at `i`, which may be a verb, is what a question asks: off and CLEAN?"""
        g, words = self._g, self._words
        if words[i - 1 : i] not in (("and",), ("or",)) or not self._np.is_last_word(i):
            return False
        first = i
        while first and not self._t.ends_sentence(first - 1):
            first -= 1
        end = next(j for j in range(i, len(words) + 1) if self._t.ends_sentence(j))
        has_subject = any(g.match(kind, words, first) for kind in ("determiner", "possessive", "all"))
        has_be = "is" in words[first:i] or "are" in words[first:i]
        is_asked = words[first] in ("is", "are") or (has_subject and has_be)
        return words[end : end + 1] == ("?",) and is_asked

    def _is_infinitive(self, i: int) -> bool:
        """Return whether *to* and a verb are at `i`."""
        return (
            self._words[i : i + 1] == ("to",)
            and self._g.verb(self._words, i + 1)[0] > 0
            and not self._np.is_known(i + 1, i + 2)
        )

    def _phase(self, i: int) -> int:
        """Return the number of words before a verb that only state its phase: START cleaning; or 0."""
        length = self._g.match("phase", self._words, i)
        return self._activity(i + length) - i if length and self._activity(i + length) else 0

    def _activity(self, i: int) -> int:
        """Return the index of the verb that is the object of a verb before `i`, or 0.

        It is *following Nora* or *to follow Nora*, and in Italian *di seguire Nora*.
        """
        j = i
        while self._t.is_translated and self._words[j : j + 1] in (("it",), ("of",), ("to",)):
            j += 1  # smettila di seguirmi
        is_base = j > i or self._words[i - 1 : i] == ("to",)
        return j if self._g.gerund(self._words, j)[0] or (is_base and self._g.verb(self._words, j)[0]) else 0

    def _is_gerund(self, i: int) -> bool:
        return self._words[i].endswith("ing") and (self._words[i],) not in self._g.verbs

    def _opens_phrase(self, i: int) -> bool:
        words, g = self._words, self._g
        if i >= len(words):
            return False
        return any(
            g.match(kind, words, i) for kind in ("determiner", "pronoun", "possessive", "speaker", "all")
        ) or (self._t.tokens[i].is_capital)

    def _wish(self, i: int) -> int:
        """Return the number of words of a wish at `i`: I need, I would like, can I have; or 0."""
        length = self._g.match("wish", self._words, i)
        return 0 if self._words[i + length : i + length + 1] in (("to",), ("you",)) else length

    def _lets_know(self, i: int) -> int:
        """Return the index of the second verb of *let me know* at `i`, or 0."""
        phrase = self._np.read(i + 1) if self._words[i] == "let" else None
        knows = phrase is not None and self._words[phrase.end : phrase.end + 1] in (("know",), ("hear",))
        return phrase.end if phrase is not None and knows else 0

    def _asks(self, i: int) -> bool:
        """Return whether a question begins at `i`: how many cups are there, where is Anna."""
        is_yes_no = self._g.is_a(self._words[i], "be") and self._words[i] in ("is", "are")
        if not self._g.match("question", self._words, i) and not is_yes_no:
            return False
        if is_yes_no and i and self._words[i - 1] not in (".", "?", "!", ";", "robot"):
            return False
        if i and self._words[i - 1] not in _BEFORE_QUESTION:
            return False
        if (
            self._words[i] in ("who", "which")
            and self._words[i - 1] == ","
            and self._t.tokens[i - 2].is_capital
        ):
            return i == 2 and self._words[0] in _BEFORE_QUESTION  # Anna, who is in the kitchen
        if self._wish(i) or self._g.match("polite", self._words, i) > 1:
            return False  # how about you take it
        return self._words[i] not in ("when", "whether") or (
            i + 1 < len(self._words) and self._words[i + 1] in ("is", "was", "did")
        )

    def _found_at(self, i: int) -> bool:
        """Return whether a clause about a place begins at `i`: you find him at the bed; there is a cup."""
        words, g = self._words, self._g
        if words[i : i + 1] == ("you",) and i + 2 < len(words):
            return (
                words[i + 1] in ("can", "may", "might", "will", "should", "could", "'ll")
                and words[i + 2] in ("find", "meet", "see", "spot", "probably", "likely", "also", "surely")
            ) or (words[i + 1] in ("find",))
        if words[i : i + 1] == ("there",) and i + 2 < len(words):
            return g.is_a(words[i + 1 + g.is_a(words[i + 1], "modal")], "be")
        if self._states_place(i):
            return True
        subject = i < len(words) and (
            words[i] in ("he", "she", "they", "it")
            or (self._t.tokens[i].is_capital and not g.verb(words, i)[0] and i + 1 < len(words))
        )
        if not subject:
            return False
        be = self._after_adverbs(i + 1)
        return (
            be < len(words)
            and g.is_a(words[be], "be")
            and g.match("place", words, self._after_adverbs(be + 1)) > 0
        )

    def _states_place(self, i: int) -> bool:
        """Return whether a statement of a place begins at `i`: the cup is on the desk, someone is waving."""
        if i >= len(self._words) or not (
            self._g.match("determiner", self._words, i)
            or self._g.is_a(self._words[i], "possessive")
            or self._words[i].startswith(("some", "any", "every"))
        ):
            return False
        if i and self._words[i - 1] not in (",", ".", "!", ";", "?", "and", "then"):
            return False
        phrase = self._np.read(i)
        if phrase is None or phrase.end + 1 >= len(self._words):
            return False
        be = self._after_adverbs(phrase.end)
        behind = self._after_adverbs(be + 1)
        if behind >= len(self._words) or not self._g.is_a(self._words[be], "be"):
            return False
        waves = phrase.kind == "person" and self._g.is_a(self._words[behind], "posture")
        return waves or self._g.match("place", self._words, behind) > 0

    def _after_adverbs(self, i: int) -> int:
        """Return the index after modal verbs and adverbs at `i`: SHOULD PROBABLY be."""
        while i < len(self._words) and (
            self._g.is_a(self._words[i], "modal") or self._g.is_a(self._words[i], "stated")
        ):
            i += 1
        return i

    def _then(self, i: int) -> int:
        """Return the number of words of *and*, *then* or *when you are done* at `i`, or 0."""
        length, words = self._g.match("then", self._words, i), self._words
        belongs = words[i : i + 1] == ("so",) and i > 0 and words[i - 1] in _BEFORE_OTHERWISE  # if I say so
        following = words[i + length] if i + length < len(words) else ""
        is_begun = following == "with" or (words[i + length - 1] == "there" and self._g.is_a(following, "be"))
        return 0 if belongs or (length and is_begun) else length

    def _anaphoric(self, i: int) -> int:
        """Return the number of words of a condition on what was said before at `i` (otherwise), or 0."""
        length = self._g.match("anaphoric", self._words, i)
        before = self._words[i - 1] if i else ""
        if length and before in (_BEFORE_ELSE if self._words[i] == "else" else _BEFORE_OTHERWISE):
            return 0
        is_open = length and self._words[i] == "if" and not self._t.is_mark(i + length)
        if is_open and (self._t.is_translated and self._words[i + 1] == "not"):  # se non trovi il latte
            return 0
        return 0 if is_open and not self.starts_clause(i + length) else length  # if not too cold

    def _excludes(self, i: int) -> bool:
        """Return whether an exception begins at `i`: but not the milk."""
        length = self._np.exclusion(i)
        has_noun = self._opens_phrase(i + length) or (length == 2 and self._words[i + 1] == "no")
        return bool(length) and has_noun and not self._g.verb(self._words, i + length)[0]
