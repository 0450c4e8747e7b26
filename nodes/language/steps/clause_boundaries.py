"""Where the clauses of a command begin and end."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

from semmap.nodes.language.lexicon.commands import Grammar
from semmap.nodes.language.reference_resolution.map_index import Nouns
from semmap.nodes.language.steps.clause import Clause, Parsed
from semmap.nodes.language.steps.noun_group import ALWAYS_VERBS
from semmap.nodes.language.steps.noun_phrase import NounPhraseReader
from semmap.nodes.language.steps.phrase import NounPhrase
from semmap.nodes.language.steps.times import starts_time
from semmap.nodes.language.steps.tokens import Text

_BEFORE_VERB: Final = frozenset(
    ("to", "not", "n't", "and", "or", "'s", "the", "a", "i", "you", "we", "they", "my", "your", "cannot")
)
"""Words after which a verb begins no clause."""
_AFTER_VERB: Final = ("to", "from", "place", "about", "here", "question", "direction")
"""Classes of expressions that may follow the verb of a command."""
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


class ClauseBoundaries:
    """Finds where clauses begin and end in one text; the readers of clauses extend it."""

    def __init__(self, text: Text, grammar: Grammar, nouns: Nouns, is_person: Callable[[NounPhrase], bool],
                 above: Mapping[str, frozenset[str]]) -> None:  # fmt: skip
        """Read clauses of `text`. `is_person` tells whether a phrase denotes a person."""
        self._t, self._g, self._words = text, grammar, text.words
        self._is_person = is_person
        self._np = NounPhraseReader(text, grammar, nouns, self.starts_clause, above)
        self._nouns = nouns
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
        if (
            (g.match("negation", words, j) and not self._excludes(j))
            or self._phase(j)
            or g.match("condition", words, j)
            or self._anaphoric(j)
            or self._found_at(j)
            or self._asks(j)
        ):
            return True
        length, _ = g.verb(words, j)
        if self._lets_know(j) or (g.is_a(words[j], "untaught") and not self._np.is_known(j, j + 1)):
            return True
        if not length or self._is_gerund(j):
            return False
        if length > 1:
            return True
        following = words[j + 1] if j + 1 < len(words) else ""
        if self._np.is_known(j, j + 1) and not self._opens_phrase(j + 1):
            return False
        return following not in ("of", "is", "are", "'s")

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

    def _lets_know(self, i: int) -> bool:
        """Return whether *let me know* begins at `i`."""
        if self._words[i] != "let":
            return False
        phrase = self._np.read(i + 1)
        return phrase is not None and self._words[phrase.end : phrase.end + 1] in (("know",), ("hear",))

    def _asks(self, i: int) -> bool:
        """Return whether a question begins at `i`: how many cups are there, where is Anna."""
        is_yes_no = self._g.is_a(self._words[i], "be") and self._words[i] in ("is", "are")
        if not self._g.match("question", self._words, i) and not is_yes_no:
            return False
        if is_yes_no and i and self._words[i - 1] not in (".", "?", "!", ";", "robot"):
            return False
        if i and self._words[i - 1] not in (
            ",",
            ".",
            "?",
            "!",
            ";",
            "and",
            "then",
            "robot",
            "please",
            "hey",
            "hello",
            "hi",
            "also",
            "so",
            "okay",
            "ok",
            "but",
        ):
            return False
        if self._wish(i):
            return False
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

    def _then(self, i: int) -> int:
        """Return the number of words of *and*, *then* or *when you are done* at `i`, or 0."""
        length, words = self._g.match("then", self._words, i), self._words
        belongs = words[i : i + 1] == ("so",) and i > 0 and words[i - 1] in _BEFORE_OTHERWISE  # if I say so
        following = words[i + length] if i + length < len(words) else ""
        is_begun = following == "with" or (words[i + length - 1] == "there" and self._g.is_a(following, "be"))
        return 0 if belongs or (length and is_begun) else length

    def _subordinates(self, i: int) -> int:
        """Return the number of words of a conjunction at `i` that begins a subordinate clause, or 0."""
        g, words = self._g, self._words
        length = g.match("condition", words, i)
        if (span := self._np.duration(i)) and words[i + span : i + span + 1] in (("before",), ("after",)):
            return span + 1  # five minutes after Anna leaves
        if length and (self._then(i) >= length or starts_time(g, words, i) or g.match("manner", words, i) > length):
            return 0  # as soon as possible
        is_first = (
            not length and words[i : i + 1] == ("should",) and self._t.is_mark(i - 1 if i else len(words))
        )
        return int(is_first and words[i + 1 : i + 2] != ("i",)) or length  # should Anna arrive, greet her

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
        return j < len(words) and (self._orders(j) or self._lets_know(j))

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
        if self._excludes(i):
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

    def _subordinate(self, i: int, end: int) -> str:
        """Return the text of a condition; note whether it no longer holds for what follows it."""
        g, words = self._g, self._words
        text = self._t.between(i, end)
        if g.match("until", words, i) or (g.match("lasting", words, i) and "then" in words[end : end + 2]):
            self._ending.add(text)
        return text

    def _mention_all(self, i: int, end: int, *, only_persons: bool = False) -> None:
        """Note the things and persons from `i` to before `end`, to which a later pronoun may refer."""
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
            if (phrase.kind == "person" or is_name or is_thing) and not phrase.amount.is_none:
                others.append(phrase)  # the last one, to which a pronoun refers first
            self.found.context += ((len(self.found.clauses), other) for other in others)
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

    def _excludes(self, i: int) -> bool:
        """Return whether an exception begins at `i`: but not the milk."""
        length = self._np.exclusion(i)
        has_noun = self._opens_phrase(i + length) or (length == 2 and self._words[i + 1] == "no")
        return bool(length) and has_noun and not self._g.verb(self._words, i + length)[0]
