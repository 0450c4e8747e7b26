"""Noun phrases of commands: the attributes of a thing or person, in the order of the words."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, Literal

from semmap.nodes.language.lexicon.commands import Grammar
from semmap.nodes.language.reference_resolution.map_index import MOST_WORDS, Nouns
from semmap.nodes.language.steps.tokens import Text

Kind = Literal["thing", "person", "name", "pronoun", "speaker", "robot", "here"]
_PREPOSITIONS: Final = ("to", "from", "place", "for", "about", "with", "of", "path", "exclude")
_NEVER_INSIDE: Final = (
    "and",
    "be",
    "have",
    "modal",
    "speaker",
    "condition",
    "question",
    "negation",
    "manner",
)
_ONLY_FIRST: Final = ("determiner", "all", "possessive", "pronoun", "relative")
_ALWAYS_VERBS: Final = frozenset(("bring", "take", "give", "put", "tell", "follow", "go", "find"))
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
    )
)
_SEVERAL: Final = frozenset(("these", "those", "several", "a few", "both", "a pair of", "a couple of"))


@dataclass(slots=True)
class PlacePhrase:
    """Where a described thing is: a preposition and the thing it relates to."""

    preposition: str
    other: NounPhrase
    first: int
    end: int
    negated: bool = False


@dataclass(slots=True)
class NounPhrase:
    """A noun phrase: the indices of its words and what they say.

    `noun` is the noun as written, `key` its base form, and `attributes` are qualities as written.
    """

    first: int
    end: int = 0
    head: int = 0
    kind: Kind = "thing"
    noun: str = ""
    key: str = ""
    name: str = ""
    determiner: str = ""
    attributes: list[str] = field(default_factory=list)
    superlative: str = ""
    quantity: int | None = None
    all_of: bool = False
    purpose: str = ""
    is_plural: bool = False
    places: list[PlacePhrase] = field(default_factory=list)
    owner: NounPhrase | None = None
    of: NounPhrase | None = None
    second: NounPhrase | None = None
    """The other thing after *between*."""
    excluded: list[NounPhrase] = field(default_factory=list)

    @property
    def is_definite(self) -> bool:
        """Return whether the phrase denotes one particular thing."""
        return self.determiner in (
            "the",
            "this",
            "that",
            "my",
            "your",
            "his",
            "her",
            "their",
            "its",
            "our",
        ) or (self.owner is not None)


class NounPhraseReader:
    """Reads noun phrases of one text."""

    def __init__(
        self,
        text: Text,
        grammar: Grammar,
        nouns: Nouns,
        starts_clause: Callable[[int], bool],
        above: Mapping[str, frozenset[str]],
    ) -> None:
        """Read phrases of `text`.

        `starts_clause` returns whether a new clause begins at an index. `above` maps classes to their
        superclasses.
        """
        self._t, self._g, self._nouns, self._starts_clause = text, grammar, nouns, starts_clause
        self._above = above
        self._words = text.words
        self._bases = [nouns.describing.base(word) for word in text.words]

    def is_known(self, first: int, end: int) -> bool:
        """Return whether the words are a noun of the map or the TBox."""
        return end - first <= MOST_WORDS and bool(self.key(first, end))

    def key(self, first: int, end: int) -> str:
        """Return the key by which the words are a known noun, or ""."""
        words = [word for base in self._bases[first:end] for word in base.split("-")]
        for key in (" ".join(words), "".join(words)):
            if self._nouns.is_noun(key):
                return key
        return ""

    def read(self, i: int, *, with_places: bool = True) -> NounPhrase | None:
        """Return the noun phrase that begins at `i`, or None.

        `with_places` tells whether phrases such as *in the kitchen* after the noun belong to it.
        """
        if self._t.is_mark(i):
            return None
        phrase = NounPhrase(i)
        if self._read_pronoun(phrase):
            if phrase.kind == "person":
                self._after_the_noun(phrase, with_places)
            return phrase
        start = self._determiners(phrase, i)
        if start > i and self._words[start - 1 : start] == ("of",) and self._read_pronoun_at(phrase, start):
            return phrase
        end = self._group_end(start)
        if end == start:
            if start == i:
                return None
            if self._words[i] in ("this", "that", "these", "those", "all", "both", "another"):
                phrase.kind, phrase.head, phrase.end, phrase.noun = "pronoun", i, start, self._words[i]
                return phrase
            if phrase.quantity is None:
                return None
            phrase.noun, phrase.head, phrase.end = self._words[start - 1], start - 1, start
            return phrase
        self._group(phrase, start, end)
        if phrase.end < len(self._words) and self._is_possessive(phrase.end):
            return self._owned(phrase, i, with_places)
        self._after_the_noun(phrase, with_places)
        return phrase

    # Pronouns and determiners

    def _read_pronoun(self, phrase: NounPhrase) -> bool:
        return self._read_pronoun_at(phrase, phrase.first)

    def _read_pronoun_at(self, phrase: NounPhrase, i: int) -> bool:
        """Read a pronoun at `i`, unless it is a determiner there."""
        g, words = self._g, self._words
        word = words[i] if i < len(words) else ""
        kind: Kind | None = None
        if g.is_a(word, "speaker"):
            kind = "speaker"
        elif g.is_a(word, "robot"):
            kind = "robot"
        elif length := g.match("here", words, i):
            phrase.kind, phrase.head, phrase.end, phrase.noun = "here", i, i + length, word
            return True
        elif length := g.match("pronoun", words, i):
            if not self._is_determiner(i, length):
                phrase.kind, phrase.head, phrase.end = "pronoun", i + length - 1, i + length
                phrase.noun = " ".join(words[i : i + length])
                return True
        elif word in (
            "everyone",
            "everybody",
            "someone",
            "somebody",
            "anyone",
            "anybody",
            "nobody",
            "folks",
            "whoever",
        ):
            phrase.kind, phrase.head, phrase.end, phrase.noun = "person", i, i + 1, word
            phrase.all_of = g.is_a(word, "everyone")
            return True
        if kind is None:
            return False
        phrase.kind, phrase.head, phrase.end, phrase.noun = kind, i, i + 1, word
        return True

    def _is_determiner(self, i: int, length: int) -> bool:
        """Return whether the word at `i` precedes a noun: her phone, that cup, this one."""
        word = self._words[i]
        if length > 1 or not (
            self._g.is_a(word, "determiner") or self._g.is_a(word, "possessive") or word == "one"
        ):
            return False
        return self._group_end(i + 1) > i + 1

    def _determiners(self, phrase: NounPhrase, i: int) -> int:
        g, words = self._g, self._words
        while i < len(words):
            number = g.number(words[i])
            every, length = g.match("all", words, i), g.match("determiner", words, i)
            if every and every >= length:
                phrase.all_of, phrase.is_plural, phrase.determiner = True, True, phrase.determiner or "all"
                i += every
            elif length:
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
                and self._group_end(i + 1) > i + 1
            ):
                phrase.quantity, phrase.is_plural = number, number > 1
                i += 1
                if words[i : i + 2] == ("of", "the"):
                    i += 2
            else:
                break
        return i

    # The noun and the words before it

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
            ):
                break
            if i > start and word == "one":
                return i + 1
            if any(g.is_a(word, kind) for kind in _ONLY_FIRST) and not self.is_known(i, i + 1):
                break
            if seen and (g.is_a(word, "posture") or g.is_a(word, "particle") or word in _ALWAYS_VERBS):
                break
            if seen and g.is_a(word, "stative"):
                break
            if i > start and self._is_bare_name(start) and not self._t.tokens[i].is_capital:
                break  # let ANNA know
            if seen and word.endswith("s") and (word[:-1],) in g.verbs:
                break  # how the person looks
            if seen and (g.match("time", words, i) or word in ("called", "named")):
                break
            seen = seen or self.is_known(i, i + 1) or g.is_a(self._bases[i], "person") or self._is_kind(i)
            seen = seen or g.is_a(self._bases[i], "anything") or self._t.tokens[i].is_capital
            i += 1
        return i

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

    def _is_possessive(self, i: int) -> bool:
        """Return whether the word at `i` is a possessive ending, and not *is*."""
        if self._words[i] not in ("'s", "'"):
            return False
        following = self._words[i + 1] if i + 1 < len(self._words) else ","
        is_place = self._g.match("place", self._words, i + 1) or self._g.is_a(following, "posture")
        return not (self._t.is_mark(i + 1) or is_place or self._g.is_a(following, "determiner"))

    def _owned(self, owner: NounPhrase, first: int, with_places: bool) -> NounPhrase:
        """Return the phrase whose owner is another phrase: Anna's cup."""
        start = owner.end + 1
        phrase = NounPhrase(first, owner=owner, determiner="the")
        end = self._group_end(start)
        if end == start:
            owner.end += 1
            return owner
        self._group(phrase, start, end)
        phrase.first = first
        self._after_the_noun(phrase, with_places)
        return phrase

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
            noun = head
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
        self._modifiers(phrase, start, noun)

    def _unknown_noun(self, start: int, end: int) -> int:
        """Return the index of the first word of an unknown noun: the words after the known modifiers."""
        i = start
        while i < end - 1 and (self._is_modifier(i) or self._superlative(i, end)):
            i += max(1, self._superlative(i, end))
        return i

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
            elif self._words[i] in ("very", "other", "same", "own", "whole", "entire", "little"):
                i += 1
            else:
                phrase.attributes.append(self._words[i])
                i += 1

    # After the noun

    def read_place(self, i: int) -> PlacePhrase | None:
        """Return the place phrase that begins at `i`, such as *in the kitchen*, or None."""
        return self._place(i)

    def continue_phrase(self, phrase: NounPhrase, *, after_be: bool) -> None:
        """Add to a phrase what follows it after a verb: are WEARING RED SHIRTS, are OPEN."""
        i = phrase.end
        self._after_the_noun(phrase, True)
        if phrase.end == i and after_be and not self._t.is_mark(i):
            start = i + self._g.match("determiner", self._words, i)
            end = self._group_end(start)
            if end > start and (length := self._superlative(start, end + 1)):
                phrase.superlative = " ".join(self._words[start : start + length])
            elif end > i:
                phrase.attributes.append(self._t.between(i, end))
            phrase.end = max(end, i)

    def _after_the_noun(self, phrase: NounPhrase, with_places: bool) -> None:
        """Read what follows the noun: places, relative clauses, participles, purposes, exceptions."""
        g, words = self._g, self._words
        while (i := phrase.end) < len(words):
            if length := g.match("exclude", words, i):
                other = self.read(i + length, with_places=False)
                if other is None:
                    return
                phrase.excluded.append(other)
                phrase.end = other.end
            elif words[i] in ("called", "named") and not self._t.is_mark(i + 1):
                end = self._group_end(i + 1)
                phrase.name, phrase.end = self._t.between(i + 1, end), max(end, i + 1)
            elif phrase.noun and words[i] == "to" and i + 1 < len(words) and words[i + 1] in g.purposes:
                phrase.purpose, phrase.end = words[i + 1], i + 2
            elif (
                words[i] == ","
                and phrase.kind != "pronoun"
                and words[i + 1 : i + 2] in (("who",), ("which",))
            ):
                if not self._relative(phrase, i + 1, with_places):
                    return
                phrase.end += words[phrase.end : phrase.end + 1] == (",",)
            elif g.is_a(words[i], "relative") and i + 1 < len(words):
                if not self._relative(phrase, i, with_places):
                    return
            elif (phrase.noun == "whoever" or phrase.determiner in ("whatever", "whichever")) and g.is_a(
                words[i], "be"
            ):
                if not self._relative(phrase, i - 1, with_places):
                    return
            elif phrase.superlative and words[i] == "from" and (length := self._counted_from(i)):
                phrase.superlative = f"{phrase.superlative} {' '.join(words[i : i + length])}"
                phrase.end = i + length
            elif (
                g.is_a(words[i], "posture")
                or (words[i] == "with" and (phrase.kind == "person" or self._is_with(i)))
                or (words[i] in ("in", "dressed") and phrase.kind == "person" and self._is_clothing(i + 1))
            ):
                self._participle(phrase, i, i)
            elif words[i] == "of" and phrase.of is None and not self._t.is_mark(i + 1):
                other = self.read(i + 1, with_places=with_places)
                if other is None:
                    return
                phrase.of, phrase.end = other, other.end
            elif with_places and (place := self._place(i)) is not None:
                phrase.places.append(place)
                phrase.end = place.end
            else:
                return

    def _counted_from(self, i: int) -> int:
        """Return the number of words of *from the left* at `i`, or 0."""
        length = 1 + (self._words[i + 1 : i + 2] == ("the",))
        return (
            length + 1
            if self._words[i + length : i + length + 1] in (("left",), ("right",), ("top",), ("bottom",))
            else 0
        )

    def _place(self, i: int, negated: bool = False) -> PlacePhrase | None:
        """Return the place phrase that begins at `i`, or None."""
        length = self._g.match("place", self._words, i)
        if not length or self._starts_time(i) or self._g.match("here", self._words, i):
            return None
        preposition = " ".join(self._words[i : i + length])
        other = self.read(i + length)
        if other is None or (other.kind == "name" and other.noun in ("order",)):
            return None
        if preposition == "between" and self._words[other.end : other.end + 1] == ("and",):
            second = self.read(other.end + 1)
            if second is not None:
                other.end, other.second = second.end, second
        return PlacePhrase(preposition, other, i, other.end, negated)

    def _starts_time(self, i: int) -> bool:
        return starts_time(self._g, self._words, i) > 0

    def _relative(self, phrase: NounPhrase, i: int, with_places: bool) -> bool:
        """Read a relative clause at `i`; return whether there is one."""
        g, words = self._g, self._words
        j = i + 1
        has_be = has_have = negated = False
        while j < len(words) and (
            g.is_a(words[j], "be")
            or g.is_a(words[j], "have")
            or g.is_a(words[j], "modal")
            or words[j] in ("not", "n't", "never", "currently")
        ):
            has_be = has_be or g.is_a(words[j], "be")
            has_have = has_have or g.is_a(words[j], "have")
            negated = negated or words[j] in ("not", "n't", "never")
            j += 1
        is_that_clause = (
            words[i] == "that"
            and j == i + 1
            and (phrase.kind != "thing" or phrase.key in self._nouns.entities)
        )
        if self._t.is_mark(j) or (is_that_clause and not g.is_a(words[j], "posture")):
            return False
        if (has_be or not has_have) and g.is_a(words[j], "posture"):
            self._participle(phrase, j, i if negated else j, negated=negated)
            return True
        if has_be and (place := self._place(j, negated)) is not None:
            if not with_places and not negated:
                return False
            phrase.places.append(place)
            phrase.end = place.end
            return True
        if has_be and words[j] in ("called", "named"):
            end = self._group_end(j + 1)
            phrase.name, phrase.end = self._t.between(j + 1, end), end
            return True
        if has_be:
            end = max(self._group_end(j), j + 1)
            phrase.attributes.append(("not " if negated else "") + self._t.between(j, end))
            phrase.end = end
            return True
        self._participle(phrase, j, i if not has_have else j, negated=negated)
        return True

    def _is_with(self, i: int) -> bool:
        return not self._t.is_mark(i + 1)

    def _is_clothing(self, i: int) -> bool:
        """Return whether the words at `i` are clothes or a colour, and not a place of the map."""
        start = i + self._g.match("determiner", self._words, i)
        end = self._group_end(start)
        if end == start or self._words[i] in ("the", "my", "your", "this", "that"):
            return self._words[i : i + 1] == ("the",) and bool(
                end > start and self._is_color(start) and not self.key(start, end)
            )
        key = next((key for j in range(start, end) if (key := self.key(j, end))), "")
        is_there = bool(key) and (
            key in self._nouns.entities
            or any("Location" in self._above.get(name, ()) for name in self._nouns.classes.get(key, ()))
        )
        return not is_there or self._is_color(start)

    def _is_color(self, i: int) -> bool:
        return self._bases[i] in self._nouns.qualities

    def _participle(self, phrase: NounPhrase, i: int, first: int, *, negated: bool = False) -> None:
        """Read an attribute of several words at `i`: raising their left arm, pointing to the right."""
        g, words = self._g, self._words
        j, may_go_to = i + 1, True
        takes_place = g.is_a(words[i], "posture_at")
        while not self._t.is_mark(j):
            if g.is_a(words[j], "and"):
                if (
                    self._starts_clause(j)
                    or self._starts_clause(j + 1)
                    or (takes_place and not g.is_a(words[j + 1], "posture"))
                ):
                    break
            elif (
                words[j] in ("to", "towards", "at")
                and may_go_to
                and not takes_place
                and self._is_direction(j, words[i])
            ):
                may_go_to = False
                j += 1
                while not self._t.is_mark(j) and (
                    g.match("determiner", words, j) or g.is_a(words[j], "possessive")
                ):
                    j += 1
            elif (
                words[j] in ("on", "over", "in", "above")
                and j + 1 < len(words)
                and g.is_a(words[j + 1], "possessive")
            ):
                j += 1  # with his hands on his head
            elif words[j] == "with" or words[j] == "of":
                pass
            elif (
                any(
                    g.match(kind, words, j)
                    for kind in ("to", "from", "place", "for", "relative", "be", "condition")
                )
                and not (g.is_a(words[j], "direction") and words[j] not in ("left of", "right of"))
            ) or (
                g.match("time", words, j)
                or words[j] in ("please", "then", "and", "so")
                or (g.is_a(words[j], "speaker"))
            ):
                break
            j += 1
        text = self._t.between(i, j)
        phrase.attributes.append(f"not {text}" if negated else text)
        phrase.end = j

    def _is_direction(self, i: int, verb: str) -> bool:
        """Return whether *to ...* belongs to a gesture: to the left, at the door."""
        j = i + 1
        while j < len(self._words) and self._words[j] in ("the", "his", "her", "their"):
            j += 1
        if j < len(self._words) and self._g.is_a(self._words[j], "direction"):
            return True
        return (
            verb in ("pointing", "points", "looking", "waving", "facing", "gesturing", "pointed")
            and self._words[i] != "to"
        ) or (verb in ("pointing", "points"))


def starts_time(g: Grammar, words: Sequence[str], i: int) -> int:
    """Return the number of words of an expression of time that begins at `i`, or 0."""
    if i >= len(words):
        return 0
    if length := g.match("time", words, i):
        return length
    word, rest = words[i], words[i + 1 :]

    def at(k: int) -> str:
        return rest[k] if k < len(rest) else ""

    def is_unit(text: str) -> bool:
        return g.is_a(text.removesuffix("s"), "unit")

    if word in ("at", "by", "around", "before", "after", "until", "from", "till", "about", "past"):
        if (at(0) in ("half", "quarter", "a") and "past" in rest[1:3]) or (
            "to" in rest[1:3] and at(0) == "quarter"
        ):
            k = 1 + (rest.index("past") if "past" in rest[1:3] else rest.index("to"))
            if g.number(at(k)) is not None:
                return k + 2
        k = 1 if at(0) in ("about", "around", "exactly", "half", "quarter") else 0
        if at(k) in ("noon", "midnight", "night", "lunchtime", "dinnertime"):
            return k + 2
        if ":" in at(k) or (at(k)[:1].isdigit() and "." in at(k)):
            return k + 2 + g.is_a(at(k + 1), "clock")
        if g.number(at(k)) is not None:
            if g.is_a(at(k + 1), "clock"):
                return k + 3
            if at(k + 1) in ("", ",", ".", "!", "?", "and", "then", "please", "today", "tomorrow"):
                return k + 2
    if word in ("in", "for", "after", "within", "before", "during", "about"):
        k = 1 if at(0) in ("about", "the", "next", "a", "an") else 0
        k += at(k) in ("couple", "few", "next", "half", "of")
        k += at(k) in ("of", "an", "a")
        number = g.number(at(k)) is not None
        if is_unit(at(k + number)) and (number or k):
            return k + number + 2
        if (
            at(0) in ("the", "a")
            and g.is_a(at(1), "day_part")
            and word in ("in", "during")
            and at(1) in ("morning", "evening", "afternoon", "night")
        ):
            return 3
    if word in ("every", "each", "this", "next", "on") and at(0):
        if word == "on" and not at(0).removesuffix("s").endswith("day"):
            return 0
        k = int(g.number(at(0)) is not None)
        part = at(k).removesuffix("s")
        if g.is_a(part, "day_part") and (word != "on" or part.endswith("day")):
            extra = 1 if at(k + 1) in ("morning", "evening", "afternoon", "night") else 0
            return k + 2 + extra
    if g.number(word) is not None and at(0) == "times":
        return 2
    if word == "tomorrow" or word == "today":
        return 1
    return 0
