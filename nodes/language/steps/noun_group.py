"""The determiners, modifiers and noun of a noun phrase: the three red cups."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

from semmap.nodes.language.lexicon.commands import Grammar
from semmap.nodes.language.reference_resolution.map_index import MOST_WORDS, Nouns
from semmap.nodes.language.steps import quantities
from semmap.nodes.language.steps.phrase import NounPhrase
from semmap.nodes.language.steps.tokens import Text

_PREPOSITIONS: Final = ("to", "from", "place", "for", "about", "with", "of", "path", "exclude")
_NEVER_INSIDE: Final = (
    "and",
    "be",
    "have",
    "modal",
    "speaker",
    "robot",
    "condition",
    "question",
    "negation",
    "manner",
)
_ONLY_FIRST: Final = ("determiner", "all", "possessive", "pronoun", "relative")
ALWAYS_VERBS: Final = frozenset(("bring", "take", "give", "put", "tell", "follow", "go", "find"))
_ADVERBS: Final = frozenset(
    (
        "please",
        "now",
        "again",
        "there",
        "here",
        "thanks",
        "then",
        "instead",
        "together",
        "immediately",
        "only",
        "back",
        "maybe",
        "perhaps",
        "as",
        "but",
        "than",
    )
)
_SEVERAL: Final = frozenset(("these", "those", "several", "a few", "both", "a pair of", "a couple of"))


class NounGroupReader:
    """Reads the words of noun phrases of one text up to the noun."""

    def __init__(
        self,
        text: Text,
        grammar: Grammar,
        nouns: Nouns,
        starts_clause: Callable[[int], bool],
        is_person: Callable[[NounPhrase], bool],
        above: Mapping[str, frozenset[str]],
    ) -> None:
        """Read phrases of `text`.

        `starts_clause` returns whether a new clause begins at an index, and `is_person` whether a phrase
        denotes a person. `above` maps classes to their superclasses.
        """
        self.is_negated = False
        self.takes_that = False
        """Whether *that* may begin a message in the clause that is read, and not a relative clause."""
        self.takes_with = False
        """Whether *with* after a thing belongs to the verb: fill the glass WITH water."""
        self._ends_at_question = False
        """Whether a question may follow the recipient of a message: tell Otto WHICH IS THE BIGGEST."""
        self.takes_predicate = False
        """Whether a further word after the noun is what a question asks of it: is the fridge OPEN."""
        self._t, self._g, self._nouns, self._starts_clause = text, grammar, nouns, starts_clause
        self._is_person, self._above = is_person, above
        self._words = text.words
        self._bases = [nouns.describing.base(word) for word in text.words]

    def is_known(self, first: int, end: int) -> bool:
        """Return whether the words are a noun of the map or the TBox."""
        return end - first <= MOST_WORDS and bool(self.key(first, end))

    def key(self, first: int, end: int) -> str:
        """Return the key by which the words are a known noun, or ""."""
        words = [word for base in self._bases[first:end] for word in base.split("-")]
        joined = "".join((*self._words[first : end - 1], *self._bases[end - 1 : end])).replace("-", "")
        for key in (" ".join(words), joined):
            if self._nouns.is_noun(key):
                return key
        return ""

    def _determiners(self, phrase: NounPhrase, i: int) -> int:
        g, words = self._g, self._words
        while i < len(words):
            if (bound := self.read_bound(i)) is not None:
                i, bounded = bound
                phrase.quantity, phrase.amount = bounded.quantity, bounded.amount
                phrase.is_plural = bounded.is_plural
                continue
            if (dozens := quantities.read_number(g, words, i))[1] > 1 and phrase.quantity is None:
                phrase.quantity, phrase.is_plural = dozens[0], True
                i = self._after_of(i + dozens[1])
                continue
            if length := quantities.read_amount(g, words, i, phrase, self.is_known(i + 1, i + 2)):
                i += length
                continue
            number = g.number(words[i])
            every, length = g.match("all", words, i), g.match("determiner", words, i)
            if every and every >= length:
                phrase.all_of, phrase.is_plural, phrase.determiner = True, True, phrase.determiner or "all"
                phrase.amount.total = 2 if g.contains("pair", " ".join(words[i : i + every])) else None
                i += every
            elif length and not (phrase.determiner and words[i] == "one"):  # the ONE OF THE kitchen
                text = " ".join(words[i : i + length])
                phrase.determiner = phrase.determiner or text
                phrase.is_plural = phrase.is_plural or text in _SEVERAL
                if text in ("a pair of", "a couple of"):
                    phrase.quantity = 2
                i += length
            elif g.is_a(words[i], "possessive"):
                phrase.determiner = words[i]
                phrase.owner = NounPhrase(
                    i, i + 1, i, "speaker" if words[i] in ("my", "our") else "pronoun", words[i]
                )
                i += 1
            elif (
                number is not None
                and (words[i] != "one" or not phrase.determiner)
                and (self._group_end(j := self._after_of(i + 1)) > j or g.is_a(words[j - 1], "of"))
            ):
                phrase.amount.is_none = phrase.amount.is_none or number == 0
                if phrase.quantity is None:
                    phrase.quantity, phrase.is_plural = number, number > 1
                else:
                    phrase.amount.total, phrase.is_plural = number, True  # two of the three cups
                i = j
            else:
                break
        return i

    def read_bound(self, i: int) -> tuple[int, NounPhrase] | None:
        """Return the index after a number with a bound at `i`, and its quantity; or None.

        A noun follows it, or the clause ends there: take AT MOST THREE.
        """
        found = quantities.read_bound(self._g, self._words, i)
        j = self._after_of(found[0]) if found is not None else i
        if found is None or (self._group_end(j) == j and not (self._t.is_mark(j) and self._is_limit(i))):
            return None
        return j, found[1]

    def _is_limit(self, i: int) -> bool:
        """Return whether an expression that only limits a number is at `i`: at most, up to, at least."""
        return any(self._g.match(kind, self._words, i) for kind in ("at_most", "at_least"))

    def _after_of(self, i: int) -> int:
        """Return the index after *of the* at `i`, or `i`."""
        is_of = self._words[i : i + 1] == ("of",)
        article = self._g.match("determiner", self._words, i + 1) if is_of else 0
        is_pronoun = is_of and self._words[i + 1 : i + 2] in (("them",), ("these",), ("those",))
        return i + 1 + (0 if is_pronoun else article) if article or is_pronoun else i

    def _group_end(self, start: int) -> int:
        """Return the index after the words before and of the noun that begin at `start`."""
        g, words = self._g, self._words
        i, seen = start, False
        while not self._t.is_mark(i):
            word = words[i]
            known = next(
                (n for n in range(min(MOST_WORDS, len(words) - i), 1, -1) if self.is_known(i, i + n)), 0
            )
            if known and not any(self._g.is_a(words[j], "and") for j in range(i, i + known)):
                i, seen = i + known, True
                continue
            if any(g.match(kind, words, i) for kind in _PREPOSITIONS) and word not in ("nearest", "closest"):
                break
            if word == "can" and i > start - 1 and not seen and self._is_noun_can(i):
                i, seen = i + 1, True
                continue
            if (
                any(g.is_a(word, kind) for kind in _NEVER_INSIDE)
                or (word in _ADVERBS and not self._follows_article(i))
                or word.startswith("n't")
                or max(g.match("condition", words, i), g.match("manner", words, i)) > 1
                or (seen and self.duration(i))
            ):
                break
            if seen and word == "left" and self._t.is_mark(i + 1):
                break
            if word == "else" and seen and not g.is_a(words[i - 1], "anything"):
                break  # the cup ELSE the bowl; but something else
            if word == "one" and (i > start or self._is_the_one(i)):
                return i + 1
            if any(g.is_a(word, kind) for kind in _ONLY_FIRST) and not self.is_known(i, i + 1):
                break
            if seen and (
                self.is_participle(i) or word == "using" or g.is_a(word, "particle") or word in ALWAYS_VERBS
            ):
                break
            if seen and any(g.match(kind, words, i) for kind in ("stative", "belonging", "owning")):
                break
            if seen and self.takes_predicate and not self._names_entity(i):
                break
            if i > start and self._is_bare_name(start) and not self._t.tokens[i].is_capital:
                break  # let ANNA know
            if seen and word.endswith("s") and (word[:-1],) in g.verbs:
                break  # how the person looks
            if seen and (
                g.match("time", words, i) or g.match("limit", words, i) or word in ("called", "named")
            ):
                break
            seen = seen or self.is_known(i, i + 1) or g.is_a(self._bases[i], "person") or self._is_kind(i)
            seen = seen or g.is_a(self._bases[i], "anything") or self._t.tokens[i].is_capital
            i += 1
        return i

    def _names_entity(self, i: int) -> bool:
        """Return whether the word at `i` may be the noun of a phrase: a known noun, a person or a name."""
        is_person = self._g.is_a(self._bases[i], "person") or self._is_kind(i)
        is_known = self.is_known(i, i + 1) or self._g.is_a(self._bases[i], "anything")
        return is_person or is_known or self._t.tokens[i].is_capital

    def is_participle(self, i: int) -> bool:
        """Return whether the word at `i` may begin what a person or thing does: waving, playing, stacked."""
        word = self._words[i]
        if self._g.is_a(word, "posture"):
            return True
        is_form = len(word) > 4 and word.endswith(("ing", "ed")) and not self._g.is_a(word, "no_participle")
        return (
            is_form
            and (word,) not in self._g.verbs  # bring
            and not self._g.match("condition", self._words, i)
            and not (self.is_known(i, i + 1) or self._is_modifier(i) or self._t.tokens[i].is_capital)
        )

    def duration(self, i: int) -> int:
        """Return the number of words of a number with a unit of time at `i` (five minutes), or 0."""
        words = self._words[i : i + 2]
        is_unit = len(words) == 2 and self._g.is_a(words[1].removesuffix("s"), "unit")
        return 2 if is_unit and (words[0] in ("a", "an") or self._g.number(words[0]) is not None) else 0

    def _is_the_one(self, i: int) -> bool:
        return i > 0 and self._words[i - 1] == "the" and not self.is_known(i + 1, i + 2)

    def _follows_article(self, i: int) -> bool:
        return i > 0 and self._g.is_a(self._words[i - 1], "determiner")

    def _is_bare_name(self, i: int) -> bool:
        """Return whether a capital letter without a determiner begins a name at `i`."""
        before = self._words[i - 1] if i else ""
        return (
            bool(before)
            and self._t.tokens[i].is_capital
            and not self._g.is_a(before, "determiner")
            and not self._is_modifier(i)
        )

    def _is_noun_can(self, i: int) -> bool:
        """Return whether *can* at `i` is the noun: after a determiner or adjective, and before no verb."""
        before = self._words[i - 1] if i else ""
        return (self._g.is_a(before, "determiner") or self._is_modifier(i - 1)) if before else False

    def _is_kind(self, i: int) -> bool:
        return self._g.is_a(self._bases[i], "kind_of_person")

    def _group(self, phrase: NounPhrase, start: int, end: int) -> None:
        """Read the noun and its modifiers from `start` to before `end`."""
        g, words, describing = self._g, self._words, self._nouns.describing
        head = end - 1
        phrase.head, phrase.end = head, end
        base = self._bases[head]
        noun = next((i for i in range(max(start, end - MOST_WORDS), end) if self.is_known(i, end)), None)
        if g.is_a(base, "person") or g.is_a(words[head], "person"):
            phrase.kind, noun = "person", head
        elif self._is_kind(head):
            phrase.kind, noun = "person", head
            phrase.attributes.append(base)
        elif g.is_a(base, "anything"):
            noun, phrase.amount.is_none = head, phrase.amount.is_none or words[head] == "nothing"
        if noun is None and g.is_a(self._bases[start], "anything"):  # something sweet
            phrase.head = start
            phrase.noun, phrase.key = words[start], self.key(start, start + 1)
            self._modifiers(phrase, start + 1, end)
            return
        number = g.number(words[head]) if end - start == 1 and words[head] != "one" else None
        if noun is None and number is not None:  # bring one cup to Nora and TWO to me
            phrase.noun, phrase.quantity, phrase.is_plural = "ones", number, number > 1
            return
        may_be_chosen = words[head].endswith("est") or words[end : end + 1] == ("of",)
        is_chosen = may_be_chosen and self._superlative(head, end + 1) > 0
        if noun is None and (is_chosen or (self._t.is_translated and self._is_modifier(head))):
            phrase.noun = "one"  # the biggest (of the plates), quella rossa
            self._modifiers(phrase, start, end)
            return
        if noun is None:
            noun = self._unknown_noun(start, end)
            is_bare = not phrase.determiner and phrase.quantity is None and not phrase.all_of
            if is_bare and (self._t.tokens[noun].is_capital or end - start == 1):
                phrase.kind, phrase.name = "name", self._t.between(start, end)
                noun = start
        phrase.noun, phrase.key = " ".join(words[noun:end]), self.key(noun, end)
        several = describing.base(words[head]) != words[head] and words[head].endswith(("s", "en", "people"))
        phrase.is_plural = (
            phrase.is_plural
            or (several and words[head] not in describing.pluralia)
            or words[head] == "people"
        )
        if phrase.all_of and phrase.amount.total and not (several or self._t.is_translated):
            phrase.all_of, phrase.is_plural, phrase.amount.total = False, False, None  # both the cup and ...
        self._modifiers(phrase, start, noun)

    def _unknown_noun(self, start: int, end: int) -> int:
        """Return the index of the first word of an unknown noun: the words after the known modifiers."""
        i = start
        while i < end - 1 and (self._is_modifier(i) or self._superlative(i, end)):
            i += max(1, self._superlative(i, end))
        return min(i, end - 1)  # a superlative may be all there is

    def _is_modifier(self, i: int) -> bool:
        word, base = self._words[i], self._bases[i]
        senses = self._nouns.describing.sense((word,))
        return bool(
            base in self._nouns.qualities
            or any(kind in senses for kind in ("sizes", "states", "sides", "ordinals"))
            or self._g.is_a(word, "posture")
        )

    def _superlative(self, i: int, end: int) -> int:
        """Return the number of words of a superlative at `i`, or 0."""
        word = self._words[i]
        if word in ("most", "least") and i + 1 < end:
            return 2
        senses = self._nouns.describing.sense((word,))
        if self._g.is_a(word, "superlative") or "sides" in senses or "ordinals" in senses:
            return 1
        return int(len(word) > 4 and word.endswith("est") and not self.is_known(i, i + 1) and i + 1 < end)

    def _modifiers(self, phrase: NounPhrase, start: int, end: int) -> None:
        i = start
        while i < end:
            number = self._g.number(self._words[i])
            if length := self._superlative(i, end + 1):
                phrase.superlative = f"{phrase.superlative} {' '.join(self._words[i : i + length])}".strip()
                i += length
            elif number is not None:
                phrase.quantity, phrase.is_plural = number, phrase.is_plural or number > 1
                i += 1
            elif quantities.is_other(self._words[i]):
                phrase.amount.is_other = True
                i += 1
            elif self._words[i] == "same":
                phrase.amount.is_same = True
                i += 1
            elif self._words[i] == "single":
                phrase.quantity = 1
                i += 1
            elif self._words[i][0].isdigit():
                phrase.amount.is_vague = True  # 1.5 cups
                i += 1
            elif self._words[i] in ("very", "own", "whole", "entire"):
                i += 1
            else:
                phrase.attributes.append(self._words[i])
                i += 1
