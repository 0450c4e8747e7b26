"""Questions for yes or no: is the milk on the desk, is the fridge open, there is milk?"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from semmap.nodes.language.steps.arguments import ArgumentReader
from semmap.nodes.language.steps.clause import Clause, Role
from semmap.nodes.language.steps.phrase import Amount, NounPhrase

_SOME: Final = ("any", "some", "no", "a", "an", "one", "either", "several")
"""Determiners of phrases that do not denote certain things."""


class YesNoReader(ArgumentReader):
    """Reads questions with *is* and what they ask of their subjects."""

    def _addressed(self, clause: Clause, i: int) -> int:
        raise NotImplementedError

    def _yes_no(self, clause: Clause, i: int) -> int:
        """Read *is the milk on the desk*; of a translation also *is on the desk the milk*."""
        j = i + 1 + (self._words[i + 1 : i + 2] in (("there",), ("n't",)))
        clause.roles.append(Role("Message", i, j, i))
        place = self._np.read_place(j)
        phrase = self._subject(j if place is None else place.end)
        if phrase is None:
            return self._unread(j)
        if place is not None:
            phrase.places.append(place)
            phrase.first = place.first
        return self._add_topic(clause, phrase, asks_existence="there" in self._words[i + 1 : i + 3])

    def _add_topic(self, clause: Clause, phrase: NounPhrase, *, asks_existence: bool) -> int:
        """Add the subjects of a question and what is asked of them: are THE OVEN AND THE STOVE OFF."""
        self._read_state(phrase)
        phrases, last = [phrase], phrase
        while self._words[last.end : last.end + 1] in (("and",), ("or",)) and not (last.asked or last.places):
            if (other := self._subject(last.end + 1)) is None:
                break
            self._read_state(other)
            last = other
            phrases.append(last)
        for one in phrases[:-1]:
            one.asked, one.asks_any, one.places = last.asked, last.asks_any, last.places
        clause.roles.append(Role("Topic", phrase.first, last.end, phrase.head, phrases))
        before = len(self.found.unused)
        end = self._addressed(clause, last.end)
        for one in phrases:  # also those that are read after the first
            one.asks_existence = one.asks_existence or asks_existence
        unread = self.found.unused[before : before + 1]
        is_more = self._t.is_mark(last.end) or self._words[last.end] in ("and", "or", "there")
        if unread and not is_more and self._is_asked(phrase) and not phrase.asked:
            phrase.asked += unread  # is the light out of order: it is not known, and no yes
        return end

    def _subject(self, i: int) -> NounPhrase | None:
        """Return the phrase at `i` of a question with *is*, without what the question asks of it."""
        self._np.takes_predicate = True
        try:
            phrase = self._np.read(i)
            to = -1 if phrase is None else phrase.end
            if phrase is None or phrase.of is not None or self._words[to : to + 1] != ("to",):
                return phrase
            if (other := self._np.read(to + 1)) is not None and other.key:  # the door to the kitchen
                phrase.of, phrase.end = other, other.end
            return phrase
        finally:
            self._np.takes_predicate = False

    def _read_state(self, phrase: NounPhrase) -> None:
        """Add to a phrase what a question with *is* states of it: (is the milk) not on the desk."""
        words = self._words
        self._skip_adverbs(phrase)  # is it STILL open
        length = self._g.match("negation", words, phrase.end)
        place = self._np.read_place(phrase.end + length) if length else None
        if place is not None:
            place.negated = True
            phrase.places.append(place)
            phrase.end = place.end
            return
        is_asked = self._is_asked(phrase)
        before, places, first = len(phrase.attributes), len(phrase.places), phrase.end
        superlative = phrase.superlative
        phrase.end += length
        self._np.continue_phrase(phrase, after_be=True)
        if phrase.superlative != superlative:  # is the cup BIGGER: not a cup that is bigger
            phrase.superlative = superlative
            phrase.attributes.append(self._t.between(first + length, phrase.end))
        if len(phrase.attributes) > before and words[phrase.end : phrase.end + 1] == ("than",):
            other = self._np.read(phrase.end + 1)
            phrase.end = self._clause_end(phrase.end) if other is None else other.end
            phrase.attributes[-1] = self._t.between(first + length, phrase.end)
        if len(phrase.attributes) == before:
            if is_asked and phrase.places and phrase.end == first and words[first : first + 1] == ("and",):
                self._read_alternatives(phrase)  # is the milk in the fridge AND COLD
                return
            phrase.end = phrase.end if phrase.end > first + length else first
            if phrase.end > first and len(phrase.places) == places and self._is_person(phrase):
                phrase.attributes.append(self._t.between(first, phrase.end))  # is Nora sitting
            return
        if not is_asked:
            others = NounPhrase(phrase.first, phrase.end)
            self._read_alternatives(others)  # are any cups red AND CLEAN
            if not others.asks_any:
                phrase.attributes += others.asked
                phrase.end = others.end
            return
        del phrase.attributes[before:]
        phrase.asked.append("not " * bool(length) + " ".join(words[first + length : phrase.end]))
        self._skip_adverbs(phrase)  # is it open NOW
        self._read_alternatives(phrase)

    def _skip_adverbs(self, phrase: NounPhrase) -> None:
        while not self._t.is_mark(phrase.end) and self._g.is_a(self._words[phrase.end], "relative_adverb"):
            phrase.end += 1

    def _is_asked(self, phrase: NounPhrase) -> bool:
        """Return whether a question asks something of certain things, and not whether there are any."""
        is_any = self._g.is_a(self._nouns.describing.base(phrase.noun), "anything")
        is_certain = phrase.is_definite or phrase.is_plural or phrase.kind == "pronoun" or phrase.all_of
        is_some = phrase.determiner.split()[:1] in ([word] for word in _SOME) or phrase.quantity is not None
        is_some = is_some or replace(phrase.amount, total=None) != Amount()
        return is_certain and not (is_any or is_some or self._is_person(phrase))

    def _read_alternatives(self, phrase: NounPhrase) -> None:
        """Read the further states that a question asks about: open OR CLOSED, red AND CLEAN."""
        g, words = self._g, self._words
        joined = ""
        while words[phrase.end : phrase.end + 1] in (("or",), ("and",), (",",)):
            joint, i = words[phrase.end], phrase.end + 1
            if joint != "," and joined not in ("", joint):
                return  # open or closed AND CLEAN: neither all of them nor any
            if joint == "and" and (place := self._np.read_place(i)) is not None:
                phrase.places.append(place)  # is the light on AND IN THE KITCHEN
                phrase.end = place.end
                return
            i += joint == "," and words[i : i + 1] in (("or",), ("and",))  # clean, dry, AND empty
            joint = words[i - 1]
            negated = g.match("negation", words, i)
            if joint == "or" and negated > 0 and self._t.is_mark(i + negated):
                phrase.end = i + negated  # open or not
                return
            j = i + negated
            is_listed = joint != "," or words[j + 1 : j + 2] in (("or",), ("and",), (",",))
            if not is_listed or not self._np.is_state(j):
                return
            joined = joined if joint == "," else joint
            phrase.asks_any = joined == "or"
            phrase.asked.append("not " * bool(negated) + words[j])
            phrase.end = j + 1
            self._skip_adverbs(phrase)

    def _declares(self, i: int) -> int:
        """Return the index of *is* in a question with the words of a statement at `i`, or 0.

        The milk is in the fridge? There is milk?
        """
        words = self._words
        is_first = i == 0 or self._t.is_mark(i - 1)
        end = next((j for j in range(i, len(words)) if self._t.ends_sentence(j)), len(words))
        if words[end : end + 1] != ("?",) or not is_first or self._clause_end(i + 1) < end:
            return 0
        phrase = None if self._g.match("question", words, i) else self._np.read(i)
        if phrase is None or phrase.kind == "speaker" or phrase.end + 1 >= end:
            return 0
        is_state = words[phrase.end] in ("is", "are", "'s", "'re")
        return phrase.end if is_state and not self._g.match("question", words, phrase.end + 1) else 0

    def _declared(self, clause: Clause, i: int, be: int) -> int:
        """Read *the milk is on the desk?*."""
        phrase = self._subject(i)
        is_there = phrase is not None and phrase.kind == "here"  # there is milk
        clause.roles.append(Role("Message", be, be + 1, be))
        if is_there:
            phrase = self._np.read(be + 1)
        if phrase is None:
            return self._unread(be)
        phrase.end = max(phrase.end, be + 1)
        return self._add_topic(clause, phrase, asks_existence=is_there)

    def _other_topic(self, clause: Clause, i: int) -> NounPhrase | None:
        """Return the phrase at `i` of which the same question is asked, or None."""
        before = clause.roles[-1].phrases[-1:] if clause.roles else []
        other = self._subject(i) if before and before[0].asked else self._np.read(i)
        is_word = other is not None and other.kind == "name" and not self._t.tokens[other.head].is_capital
        return None if is_word else other  # is the oven off or on and CLEAN
