"""What follows the noun of a phrase, in the order of the words: places, relative clauses and participles."""

from __future__ import annotations

from typing import Final

from semmap.nodes.language.steps.phrase import NounPhrase, PlacePhrase
from semmap.nodes.language.steps.pronoun_reader import PronounReader
from semmap.nodes.language.steps.times import starts_time

_NEGATIONS: Final = ("not", "n't", "never", "neither")
_NOT_STATED: Final = (
    *("and", "be", "have", "modal", "speaker", "robot", "condition", "question", "negation", "determiner"),
    *("all", "possessive", "pronoun", "relative_adverb", "polite", "then", "anaphoric", "here", "place"),
)
"""Classes of expressions that do not denote a state or quality."""


class PostmodifierReader(PronounReader):
    """Reads places, relative clauses, participles and states of one text."""

    def read(self, i: int, *, with_places: bool = True) -> NounPhrase | None:
        """Return the noun phrase that begins at `i`, or None; see `NounPhraseReader`."""
        raise NotImplementedError

    def is_place(self, phrase: NounPhrase) -> bool:
        """Return whether a phrase denotes a place by its class: the kitchen."""
        classes = self._nouns.classes.get(phrase.key, ())
        return phrase.kind == "thing" and any("Location" in self._above.get(name, ()) for name in classes)

    def read_place(self, i: int) -> PlacePhrase | None:
        """Return the place phrase that begins at `i`, such as *in the kitchen*, or None."""
        return self._place(i)

    def _place(self, i: int, negated: bool = False) -> PlacePhrase | None:
        """Return the place phrase that begins at `i`, or None."""
        length = self._g.match("place", self._words, i)
        if (
            not length
            or self._starts_time(i)
            or (self._is_last_particle(i) and not self._g.match("place", self._words, i + length))
            or self._g.match("manner", self._words, i)
            or self._g.match("here", self._words, i)
            or self._g.match("at_least", self._words, i)
            or self._g.match("at_most", self._words, i)
            or self._g.match("condition", self._words, i) > length
        ):
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

    def _add_place(self, phrase: NounPhrase, place: PlacePhrase) -> None:
        """Add where a thing is; an exception after that is one of the thing."""
        phrase.places.append(place)
        phrase.end = place.end
        if not place.other.all_of and place.other.determiner != "any":
            phrase.excluded += place.other.excluded  # everything on the desk except the lamp
            place.other.excluded = []

    def _starts_time(self, i: int) -> bool:
        return starts_time(self._g, self._words, i) > 0

    def is_state(self, i: int) -> bool:
        """Return whether a state or quality is at `i`: open, red, ON at the end of a clause."""
        is_known = not self._t.is_mark(i) and (self._is_modifier(i) or self._is_last_particle(i))
        return is_known or self.is_last_word(i)

    def is_last_word(self, i: int) -> bool:
        """Return whether a word at `i` is all that follows *and* and may state something: CLEAN, locked."""
        g, words = self._g, self._words
        is_last = self._ends_statement(i + 1) and not g.match("place", words, i + 1)
        if self._t.is_mark(i) or not is_last or self._t.tokens[i].is_capital:
            return False
        return not (self.is_known(i, i + 1) or any(g.match(kind, words, i) for kind in _NOT_STATED))

    def _is_last_particle(self, i: int) -> bool:
        """Return whether a particle is the last of what is stated at `i`: is the oven ON."""
        if self._t.is_mark(i) or not self._g.is_a(self._words[i], "particle"):
            return False
        return self._ends_statement(i + 1) and self._g.match("place", self._words, i) <= 1

    def _ends_statement(self, i: int) -> bool:
        """Return whether only *and*, an adverb, a time, a place or nothing may follow a state before `i`."""
        g, words = self._g, self._words
        if self._t.is_mark(i) or self._starts_time(i):
            return True
        kinds = ("and", "relative_adverb", "polite", "manner", "place")
        return any(g.match(kind, words, i) for kind in kinds)

    def _relative(self, phrase: NounPhrase, i: int, with_places: bool) -> bool:
        """Read a relative clause at `i`; return whether there is one."""
        g, words = self._g, self._words
        j = i + 1
        has_be = has_have = negated = False
        while j < len(words) and (
            g.is_a(words[j], "be")
            or g.is_a(words[j], "have")
            or g.is_a(words[j], "modal")
            or words[j] in _NEGATIONS
            or g.is_a(words[j], "relative_adverb")
        ):
            has_be = has_be or g.is_a(words[j], "be")
            has_have = has_have or g.is_a(words[j], "have")
            negated = negated or words[j] in _NEGATIONS
            j += 1
        is_that_clause = (
            words[i] == "that"
            and j == i + 1
            and self.takes_that
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
            self._add_place(phrase, place)
            return True
        if has_be and negated and (denied := self._read_denied(j)):
            if not self._includes(phrase, denied[0]):
                return False
            phrase.exclude(denied)
            phrase.end = denied[-1].end
            return True
        if has_be and words[j] in ("called", "named"):
            end = self._group_end(j + 1)
            phrase.name, phrase.end = self._t.between(j + 1, end), end
            return True
        if has_be:
            end = max(self._group_end(j + g.match("determiner", words, j)), j + 1)
            phrase.attributes.append(("not " if negated else "") + self._t.between(j, end))
            phrase.end = end
            return True
        self._participle(phrase, j, i if not has_have else j, negated=negated)
        return True

    def _read_denied(self, i: int) -> list[NounPhrase]:
        """Return the kinds that a relative clause denies at `i`: (not) A BOX, (neither) BOXES NOR BINS."""
        found: list[NounPhrase] = []
        while (other := self.read(i, with_places=False)) is not None:
            if not other.key or other.determiner not in ("", "a", "an") or other.attributes:
                return []
            found.append(other)
            i = other.end + 1
            if self._words[other.end : i] not in (("nor",), ("or",)):
                break
        return found

    def _includes(self, phrase: NounPhrase, other: NounPhrase) -> bool:
        """Return whether a noun includes another one, as things and containers include boxes."""
        kinds, below = (self._nouns.classes.get(one.key, set()) for one in (phrase, other))
        is_any = self._g.is_a(self._bases[phrase.head], "anything")
        return is_any or any(kinds.intersection(self._above.get(name, ())) for name in below)

    def _participle(self, phrase: NounPhrase, i: int, first: int, *, negated: bool = False) -> None:
        """Read an attribute of several words at `i`: raising their left arm, pointing to the right."""
        g, words = self._g, self._words
        if phrase.kind == "thing" and (place := self._place(i + 1, negated)) is not None:
            self._add_place(phrase, place)  # the book lying on the desk
            return
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
            elif words[j] in ("with", "of") or self._is_last_particle(j):
                pass
            elif (
                max(
                    g.match(kind, words, j)
                    for kind in ("to", "from", "place", "for", "relative", "be", "condition")
                )
                > g.is_a(words[j], "direction")  # UP TO the bedroom, but not: pointing UP
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

    def _is_with(self, i: int) -> bool:
        """Return whether *with* at `i` describes a thing, and is not of the verb, a hand or a person.

        The state or place of a person is not a property of a thing: close the oven with Anna gone.
        """
        other = self.read(i + 1, with_places=False)
        if other is not None and self._is_person(other):
            return False
        is_manner = self._g.match("manner", self._words, i) > 0
        return not (self.takes_with or is_manner or self._t.is_mark(i + 1) or self._words[i + 1] == "your")

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
