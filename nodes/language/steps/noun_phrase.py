"""Noun phrases of commands: the attributes of a thing or person, in the order of the words."""

from __future__ import annotations

from semmap.nodes.language.steps import quantities
from semmap.nodes.language.steps.phrase import NounPhrase
from semmap.nodes.language.steps.postmodifiers import PostmodifierReader


class NounPhraseReader(PostmodifierReader):
    """Reads noun phrases of one text."""

    def read(self, i: int, *, with_places: bool = True) -> NounPhrase | None:
        """Return the noun phrase that begins at `i`, or None.

        `with_places` tells whether phrases such as *in the kitchen* after the noun belong to it.
        """
        if self._t.is_mark(i):
            return None
        if (only := self._nothing_but(i)) and (meant := self.read(i + only, with_places=with_places)):
            meant.first = i
            return meant
        phrase = NounPhrase(i)
        if self._read_pronoun(phrase):
            if phrase.kind == "person":
                phrase.end += self._words[phrase.end : phrase.end + 1] == ("else",)  # someone else
                self._after_the_noun(phrase, with_places)
            return phrase
        if (all_but := self._all_but(i)) is not None:
            return all_but
        start = self._determiners(phrase, i)
        if start > i and self._words[start - 1 : start] == ("of",) and self._read_pronoun_at(phrase, start):
            return phrase
        end = self._group_end(start)
        if end == start:
            if start == i:
                return None
            if phrase.amount.is_other:
                phrase.noun, phrase.head, phrase.end = "ones" if phrase.is_plural else "one", start - 1, start
                phrase.end += self._words[start : start + 1] in (("one",), ("ones",))  # the other one
                self._after_the_noun(phrase, with_places)
                return phrase
            if self._words[i] in ("this", "that", "these", "those", "all", "both", "another"):
                phrase.kind, phrase.head, phrase.end, phrase.noun = "pronoun", i, start, self._words[i]
                return phrase
            if phrase.determiner in ("whatever", "whichever"):
                phrase.noun, phrase.head, phrase.end, phrase.is_plural = "anything", start - 1, start, True
                self._after_the_noun(phrase, with_places)
                return phrase
            if phrase.quantity is None:
                return None
            phrase.noun, phrase.head, phrase.end = (
                "ones",
                start - 1,
                start,
            )  # bring one cup to Nora, TWO to me
            return phrase
        self._group(phrase, start, end)
        if phrase.end < len(self._words) and self._is_possessive(phrase.end):
            return self._owned(phrase, i, with_places)
        self._after_the_noun(phrase, with_places)
        return phrase

    def read_recipient(self, i: int) -> NounPhrase | None:
        """Return the recipient of a message at `i`, or None; a question ends it: tell Otto WHO IS THERE."""
        self._ends_at_question = True
        try:
            return self.read(i)
        finally:
            self._ends_at_question = False

    def _nothing_but(self, i: int) -> int:
        """Return the number of words of *nothing but* at `i`, which is *only*; or 0."""
        is_none = self._words[i] in ("nothing", "nobody", "none") and not self.is_negated
        is_but = self._words[i + 1 : i + 2] == ("but",)
        length = (int(is_but) or self._g.match("exclude", self._words, i + 1)) if is_none else 0
        return length + 1 if length else 0

    def _all_but(self, i: int) -> NounPhrase | None:
        """Return the phrase of *all but two cups* or *all except the red cup* at `i`, or None."""
        g, words = self._g, self._words
        j = i + g.is_a(words[i], "all")
        length = int(words[j : j + 1] == ("but",)) or g.match("exclude", words, j) if j > i else 0
        other = self.read(j + length) if length else None
        if other is None:
            return None
        if not other.determiner and self._t.tokens[other.head].is_capital and self._is_person(other):  # Nora
            return NounPhrase(
                i, other.end, i, "person", "everyone", is_plural=True, all_of=True, excluded=[other]
            )
        phrase = NounPhrase(
            i, other.end, other.head, noun=other.noun, key=other.key, is_plural=True, all_of=True
        )
        if other.key not in self._nouns.classes:  # of *red cup* only *cup*
            phrase.noun = words[other.head]
            phrase.key = self.key(other.head, other.head + 1)
        phrase.determiner, phrase.places = "all", other.places
        if other.determiner == "one of the" or (other.quantity is not None and not other.determiner):
            phrase.amount.all_but = other.quantity or 1
        else:
            phrase.excluded, other.places = [other], []
        return phrase

    def _is_possessive(self, i: int) -> bool:
        """Return whether the word at `i` is a possessive ending, and not *is*."""
        if self._words[i] not in ("'s", "'"):
            return False
        following = self._words[i + 1] if i + 1 < len(self._words) else ","
        is_place = self._g.match("place", self._words, i + 1) > 0
        is_place = is_place or (not self._t.is_mark(i + 1) and self.is_participle(i + 1))
        return not (self._t.is_mark(i + 1) or is_place or self._g.is_a(following, "determiner"))

    def _owned(self, owner: NounPhrase, first: int, with_places: bool) -> NounPhrase:
        """Return the phrase whose owner is another phrase: Anna's cup."""
        start = owner.end + 1
        phrase = NounPhrase(first, owner=owner, determiner="the")
        end = self._group_end(start)
        if end == start:  # the oven's off
            self._after_the_noun(owner, with_places)
            return owner
        self._group(phrase, start, end)
        phrase.first = first
        self._after_the_noun(phrase, with_places)
        return phrase

    def read_excluded(self, i: int) -> list[NounPhrase]:
        """Return the phrases of an exception at `i`: the milk and the bread, the one on the desk.

        A place after a noun belongs to all of the things: all cups except the red cup on the table.
        """
        found: list[NounPhrase] = []
        while (other := self.read(i, with_places=False)) is not None:
            is_that = other.kind == "pronoun" and other.noun in ("that", "this", "those", "these")
            if is_that and (self._place(other.end) or self._words[other.end : other.end + 1] == ("that",)):
                other.kind, other.noun, other.determiner = "thing", "one", "the"  # quella sulla scrivania
                self._after_the_noun(other, True)
            elif other.noun in ("one", "ones") and not (
                other.attributes or other.superlative or other.quantity
            ):
                other = self.read(i) or other
            if not (other.determiner or other.attributes or other.quantity):
                other.quantity = self._g.number(other.noun)  # all cups except two
            found += [other, *other.excluded]
            other.excluded = []
            i = other.end + 1
            if not self._joins(other.end) or self._starts_clause(other.end) or self._starts_clause(i):
                break
        return found

    def _joins(self, i: int) -> bool:
        """Return whether a list goes on at `i`: a comma only before a determiner."""
        word = self._words[i] if i < len(self._words) else ""
        return self._g.is_a(word, "and") or (
            word == "," and self._g.match("determiner", self._words, i + 1) > 0
        )

    def continue_phrase(self, phrase: NounPhrase, *, after_be: bool) -> None:
        """Add to a phrase what follows it after a verb: are WEARING RED SHIRTS, are ON."""
        i = phrase.end
        self._after_the_noun(phrase, True)
        if phrase.end == i and after_be and not self._t.is_mark(i):
            start = i + self._g.match("determiner", self._words, i)
            end = self._group_end(start)
            state = i + self._g.match("negation", self._words, i)
            if end == start and self._is_last_particle(state):
                end = state + 1
            if end > start and (length := self._superlative(start, end + 1)):
                phrase.superlative = " ".join(self._words[start : start + length])
            elif end > i:
                phrase.attributes.append(self._t.between(i, end))
            phrase.end = max(end, i)

    def _after_the_noun(self, phrase: NounPhrase, with_places: bool) -> None:
        """Read what follows the noun: places, relative clauses, participles, purposes, exceptions."""
        g, words = self._g, self._words
        while (i := phrase.end) < len(words) and not self._asks(phrase, i):
            if length := quantities.limit_after(g, words, phrase):
                phrase.end = i + length
            elif end := self._limited(phrase, i):
                phrase.end = end
            elif (
                (length := self.exclusion(i))
                and not self._is_verb(i + length)
                and not (self.takes_predicate and words[i] == "not")  # is the red cup NOT RED
            ):
                excluded = self.read_excluded(i + length)
                if not excluded:
                    return
                phrase.exclude(excluded)
                phrase.end = excluded[-1].end
            elif words[i] in ("called", "named") and not self._t.is_mark(i + 1):
                end = self._group_end(i + 1)
                phrase.name, phrase.end = self._t.between(i + 1, end), max(end, i + 1)
            elif words[i] == "left" and self._t.is_mark(i + 1):
                phrase.end, phrase.asks_existence = i + 1, True  # is any milk left
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
            elif (owner := self._owner(i)) is not None:
                phrase.end = owner.end + g.match("owning", words, owner.end)
                if any(word in ("not", "n't") for word in words[i : owner.first]):
                    phrase.attributes.append(f"not {self._t.between(i, phrase.end)}")
                elif owner.kind in ("speaker", "pronoun"):
                    phrase.owner = owner
                else:
                    phrase.of = owner
            elif words[i] == "where" and not self.is_place(phrase):
                return
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
            elif words[i] == "whose" and phrase.kind == "person" and (end := self._whose(i)) > i:
                phrase.attributes.append(self._t.between(i, end))
                phrase.end = end
            elif with_places and (length := g.match("contact", words, i)) and self._place(i + length):
                phrase.end = i + length  # the books WE HAVE on the shelf
            elif (
                (self.is_participle(i) and not (self.takes_predicate and phrase.kind == "thing"))
                or (words[i] == "with" and (phrase.kind == "person" or self._is_with(i)))
                or (words[i] in ("in", "dressed") and phrase.kind == "person" and self._is_clothing(i + 1))
            ):
                self._participle(phrase, i, i)
            elif words[i] == "of" and phrase.of is None and not self._t.is_mark(i + 1):
                other = self.read(i + 1, with_places=with_places)
                if other is None:
                    return
                self._add_whole(phrase, other)
                phrase.end += self._is_person(other) and words[other.end : other.end + 1] == ("'s",)
            elif with_places and (place := self._place(i)) is not None:
                self._add_place(phrase, place)
            else:
                return

    def _asks(self, phrase: NounPhrase, i: int) -> bool:
        """Return whether a question follows the recipient of a message at `i`: (tell Otto) WHO IS THERE.

        After a common noun, *who* says which person is told: tell the man WHO IS THERE; but who she is.
        """
        if not self._ends_at_question or not self._g.match("question", self._words, i):
            return False
        is_name = not phrase.determiner and self._t.tokens[phrase.head].is_capital
        if self._words[i] != "who" or is_name or not self._is_person(phrase):
            return True
        asked = self.read(i + 1, with_places=False)
        return asked is not None and any(self._g.is_a(word, "be") for word in self._words[asked.end :][:1])

    def _limited(self, phrase: NounPhrase, i: int) -> int:
        """Read a limit of a plural after a comma (the cups, AT MOST THREE OF THEM); return its end, or 0."""
        words = self._words
        if not phrase.is_plural or phrase.quantity is not None or words[i] != ",":
            return 0
        number, taken = quantities.read_number(self._g, words, i + 1)
        found = quantities.read_bound(self._g, words, i + 1) if self._is_limit(i + 1) else None
        if found is not None:
            end, bounded = found
        elif taken:  # two at most
            bounded = NounPhrase(i, i + 1 + taken, quantity=number)
            end = bounded.end + quantities.limit_after(self._g, words, bounded)
        if found is None and (not taken or end == bounded.end):
            return 0
        end += 2 * (words[end : end + 1] == ("of",) and words[end + 1 : end + 2] in (("them",), ("these",)))
        if not self._t.is_mark(end) and not self._starts_clause(end):
            return 0
        phrase.quantity, phrase.amount = bounded.quantity, bounded.amount
        return end

    def _owner(self, i: int) -> NounPhrase | None:
        """Return whose a thing is by the words at `i`: (that) belongs to ANNA, that ANNA owns; or None."""
        is_relative = self._words[i] in ("that", "which")
        j = i + is_relative
        while is_relative and self._words[j : j + 1] in (("do",), ("does",), ("not",), ("n't",)):
            j += 1
        if length := self._g.match("belonging", self._words, j):
            return self.read(j + length, with_places=False)
        owner = self.read(j, with_places=False) if is_relative and j < len(self._words) else None
        is_owner = owner is not None and self._g.match("owning", self._words, owner.end)
        return owner if is_owner else None

    def _whose(self, i: int) -> int:
        """Return the end of a relative clause with *whose* at `i`: whose arm is raised; or `i`."""
        be = self._group_end(i + 1)
        is_clause = be > i + 1 and be + 1 < len(self._words) and self._g.is_a(self._words[be], "be")
        return max(self._group_end(be + 1), be + 2) if is_clause else i

    def _add_whole(self, phrase: NounPhrase, other: NounPhrase) -> None:
        """Add the thing after *of*: that of which one is a part, or those of which it is one."""
        phrase.end = other.end
        has_noun = bool(other.key) or other.kind == "person"
        if phrase.superlative and phrase.noun == "one" and has_noun:  # the biggest of the two plates
            phrase.kind, phrase.noun, phrase.key = other.kind, other.noun, other.key
            phrase.amount.total = other.quantity
            phrase.attributes += other.attributes
            phrase.places += other.places
            phrase.excluded += other.excluded
        elif phrase.superlative and other.quantity is not None and not other.key:  # the biggest of the two
            phrase.amount.total = other.quantity
        else:
            phrase.of = other

    def _is_verb(self, i: int) -> bool:
        """Return whether a verb is at `i`: the kitchen, but not ENTER the studio."""
        return self._g.verb(self._words, i)[0] > 0 and not self.is_known(i, i + 1)

    def _counted_from(self, i: int) -> int:
        """Return the number of words of *from the left* at `i`, or 0."""
        length = 1 + (self._words[i + 1 : i + 2] == ("the",))
        return (
            length + 1
            if self._words[i + length : i + length + 1] in (("left",), ("right",), ("top",), ("bottom",))
            else 0
        )
