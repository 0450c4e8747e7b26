"""Where the clauses of a command end, and the conditions in them."""

from __future__ import annotations

from typing import Final

from semmap.nodes.language.steps.clause import Clause
from semmap.nodes.language.steps.clause_starts import ClauseStarts
from semmap.nodes.language.steps.noun_group import ALWAYS_VERBS
from semmap.nodes.language.steps.times import starts_time

_BEFORE_VERB: Final = frozenset(
    (
        "to",
        "not",
        "n't",
        "and",
        "or",
        "'s",
        "the",
        "a",
        "i",
        "you",
        "we",
        "they",
        "my",
        "your",
        "cannot",
        "'ve",
        "'d",
        "'ll",
        "have",
        "has",
        "had",
    )
)
"""Words after which a verb begins no clause."""
_BEFORE_PLACE: Final = ("place", "to", "from")
_AFTER_VERB: Final = ("to", "from", "place", "about", "here", "question", "direction")
"""Classes of expressions that may follow the verb of a command."""


class ClauseBoundaries(ClauseStarts):
    """Finds where clauses and conditions end in one text."""

    def _condition(self, i: int, *, is_fronted: bool = False) -> int:
        """Return the end of a subordinate clause that begins at `i`, or `i`.

        One that `is_fronted` stands before its main clause: a verb after *and* may still belong to it.
        """
        words = self._words
        if length := self._anaphoric(i):
            return i + length
        start = i + self._subordinates(i)
        if start == i:
            return i
        with_verb = without = 0  # where the main clause begins if nothing else shows it
        j = start
        while not self._t.ends_sentence(j):
            if words[j] == "," and (self.starts_clause(j + 1) or not self._continues(j + 1)):
                return j
            if j > start and self._anaphoric(j):
                return j - (words[j - 1] == "and")
            if words[j] == "then":
                return j - (words[j - 1] in ("and", "but"))
            if not is_fronted and j > start and self._connects(j):
                return j
            if j > start and not self._continues_verb(j):
                length = self._g.match("negation", words, j)
                if length and self._orders(j + length) and self._has_verb(start, j):
                    return j
                verb, _ = self._g.verb(words, j)
                opens = verb > 0 and not self._is_gerund(j) and self._opens_phrase(j + verb)
                if self._has_verb(start, j):
                    if opens and j > start + 1:
                        return j
                    with_verb = with_verb or (j if self._orders(j) else 0)
                elif self._orders(j):
                    without = without or j  # after lunch close the door
                if words[j] in ("please", "could", "can") and self._g.match("polite", words, j):
                    return j
            j += 1
        is_apart = is_fronted or (i > 0 and words[i - 1] == ",")
        return (is_apart and (with_verb or without)) or j

    def _subordinates(self, i: int) -> int:
        """Return the number of words of a conjunction at `i` that begins a subordinate clause, or 0."""
        g, words = self._g, self._words
        length = g.match("condition", words, i) or int(self._is_absolute(i))
        negation = i + (words[i : i + 1] == ("but",))
        if words[negation : negation + 1] == ("not",) and (
            denied := g.match("condition", words, negation + 1)
        ):
            return negation + 1 + denied - i  # but not if it is hot
        if (span := self._np.duration(i)) and words[i + span : i + span + 1] in (("before",), ("after",)):
            return span + 1  # five minutes after Anna leaves
        if length and (
            self._then(i) >= length or starts_time(g, words, i) or g.match("manner", words, i) > length
        ):
            return 0  # as soon as possible
        is_first = (
            not length and words[i : i + 1] == ("should",) and self._t.is_mark(i - 1 if i else len(words))
        )
        return int(is_first and words[i + 1 : i + 2] != ("i",)) or length  # should Anna arrive, greet her

    def _is_absolute(self, i: int) -> bool:
        """Return whether *with* at `i` and a predicate stand before a clause: with Anna gone, close it."""
        words = self._words
        is_first = i == 0 or self._t.is_mark(i - 1) or self._g.is_a(words[i - 1], "and")
        is_with = is_first and words[i : i + 1] == ("with",)
        phrase = self._np.read(i + 1, with_places=False) if is_with else None
        if phrase is None or self._g.match("manner", words, i):
            return False
        end = next(j for j in range(phrase.head + 1, len(words) + 1) if self._t.is_mark(j))
        return end > phrase.head + 1 and words[end : end + 1] == (",",) and self.starts_clause(end + 1)

    def _connects(self, i: int) -> bool:
        """Return whether *and* at `i` joins the main clause, and not a subordinate one, with another."""
        g, words = self._g, self._words
        j = i
        while j < len(words) and (length := self._then(j)):
            j += length
        j += g.match("polite", words, j) if j > i else 0
        j += starts_time(g, words, j) if j > i else 0
        if j == i or self._t.is_mark(j):
            return False
        if self._subordinates(j) or self._wish(j):
            return True
        j += g.match("negation", words, j)
        return j < len(words) and (self._orders(j) or self._lets_know(j) > 0)

    def _orders(self, i: int) -> bool:
        """Return whether a verb is at `i` that begins a command: TAKE it, GO; but not (it is) open."""
        g, words = self._g, self._words
        length, frame = g.verb(words, i)
        if not length or self._is_gerund(i) or self._np.is_known(i, i + length):
            return False
        end = i + length
        follows = any(g.match(kind, words, end) for kind in _AFTER_VERB) or self._opens_phrase(end)
        return length > 1 or frame == "Motion" or follows or self._np.is_known(end, end + 1)

    def _continues_verb(self, j: int) -> bool:
        """Return whether the word before `j` makes a verb at `j` part of the same clause: to GO, you GO."""
        word = self._words[j - 1]
        if word in ("already", "just"):  # has just closed it; but: if it is cold just close it
            return j > 1 and self._continues_verb(j - 1)
        return word in _BEFORE_VERB or any(self._g.is_a(word, kind) for kind in ("modal", "be", "determiner"))

    def _continues(self, i: int) -> bool:
        """Return whether a list goes on at `i`, so that a comma before it ends no clause."""
        return self._words[i : i + 1] in (("or",), ("and",))

    def _has_verb(self, first: int, end: int) -> bool:
        """Return whether a subordinate clause has its verb."""
        return any(
            self._g.is_a(word, "be")
            or self._g.is_a(word, "have")
            or self._g.is_a(word, "modal")
            or (
                (word.endswith(("s", "ed", "ing")) or self._g.verb(self._words, k)[0] > 0 or k == first)
                and not self._np.is_known(k, k + 1)
                and not self._opens_phrase(k)
            )
            for k, word in enumerate(self._words[first:end], first)
        )

    def _ends_clause(self, i: int) -> bool:
        """Return whether the clause ends at `i`."""
        if self._t.ends_sentence(i):
            return True
        word = self._words[i]
        if word == ":" or (word == "," and self._states_pronoun(i + 1)):
            return True
        if self._excludes(i) or (word in ("but", "not") and self._subordinates(i)):
            return False
        if self._anaphoric(i):
            return True
        if word == "," and self._inserts(i + 1):
            return False
        verb = self._g.verb(self._words, i)[0] if word in ALWAYS_VERBS else 0
        if verb and self._opens_phrase(i + verb):  # go to the kitchen find the milk
            return True
        if word == "," or self._g.is_a(word, "and") or self._g.match("then", self._words, i):
            return self.starts_clause(i)
        return self._found_at(i) and word not in ("there", "it") and not self._t.tokens[i].is_capital

    def _states_pronoun(self, i: int) -> bool:
        """Return whether a statement with a pronoun as its subject is at `i`: he is called Ben."""
        subjects = (("he",), ("she",), ("they",), ("it",))
        return self._words[i : i + 1] in subjects and self._g.match("be", self._words, i + 1) > 0

    def _subordinate(self, i: int, end: int) -> str:
        """Return the text of a condition; note whether it no longer holds for what follows it."""
        g, words = self._g, self._words
        text = self._t.between(i, end)
        if g.match("until", words, i) or (g.match("lasting", words, i) and "then" in words[end : end + 2]):
            self._ending.add(text)
        return text

    def _mention_all(self, i: int, end: int, *, only_persons: bool = False) -> None:
        """Note the things and persons from `i` to before `end`, to which a later pronoun may refer."""
        start = len(self.found.context)
        while i < end:
            is_verb = self._g.verb(self._words, i)[0] and not self._np.is_known(i, i + 1)
            phrase = None if is_verb else self._np.read(i)
            if phrase is None or phrase.end <= i:
                i += 1
                continue
            is_name = self._is_person(phrase) and self._t.tokens[phrase.head].is_capital
            is_counted = bool(phrase.determiner or phrase.quantity is not None or phrase.is_plural)
            is_thing = bool(phrase.key and is_counted) and not only_persons
            others = [place.other for place in phrase.places if place.other.key and not only_persons]
            is_meant = (phrase.kind == "person" or is_name or is_thing) and not phrase.amount.is_none
            if is_meant:
                others.append(phrase)  # the last one, to which a pronoun refers first
            mentions = [(len(self.found.clauses), other) for other in others]
            if not is_meant or any(self._g.match(kind, self._words, i - 1) for kind in _BEFORE_PLACE):
                self.found.context[start:start] = mentions  # the cup belongs on the desk: IT is the cup
            else:
                self.found.context += mentions
            i = phrase.end

    def _add_condition(self, clause: Clause, i: int, end: int) -> None:
        """Add a condition to the clause before it; a later pronoun may refer to the persons in it."""
        clause.conditions.append(self._subordinate(i, end))
        self._mention_all(i, end, only_persons=True)

    def _inserts(self, i: int) -> bool:
        """Return whether a condition between commas is at `i`, with more of the clause after it."""
        end = self._condition(i) if self._subordinates(i) else i
        is_last = self.starts_clause(end) and not self._is_infinitive(end + 1)
        return self._words[end : end + 1] == (",",) and end > i and not is_last

    def _clause_end(self, i: int) -> int:
        while i < len(self._words) and not self._ends_clause(i):
            i += 1
        return i
