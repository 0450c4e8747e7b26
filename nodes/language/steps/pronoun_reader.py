"""Pronouns of commands, and words that are pronouns only if no noun follows."""

from __future__ import annotations

from semmap.nodes.language.steps.noun_group import NounGroupReader
from semmap.nodes.language.steps.phrase import Kind, NounPhrase


class PronounReader(NounGroupReader):
    """Reads the pronouns of one text."""

    def _read_pronoun(self, phrase: NounPhrase) -> bool:
        return self.read_bound(phrase.first) is None and self._read_pronoun_at(phrase, phrase.first)

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
        elif (length := g.match("pronoun", words, i)) and not self._is_part(i):
            longer = max(g.match("determiner", words, i), g.match("rest", words, i))
            if not self._is_determiner(i, length) and longer <= length:
                phrase.kind, phrase.head, phrase.end = "pronoun", i + length - 1, i + length
                phrase.noun = " ".join(words[i : i + length])
                phrase.quantity = 1 if phrase.noun == "one" else phrase.quantity
                is_all = g.is_a(word, "several_pronoun") and words[phrase.end : phrase.end + 1] in (
                    ("both",),
                    ("all",),
                )
                phrase.end += is_all and self._group_end(phrase.end + 1) == phrase.end + 1  # them both
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
            phrase.kind, phrase.head, phrase.noun = "person", i, word
            phrase.amount.is_other = words[i + 1 : i + 2] == ("else",)
            phrase.end = i + 1 + phrase.amount.is_other
            phrase.all_of, phrase.amount.is_none = g.is_a(word, "everyone"), word == "nobody"
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

    def _is_part(self, i: int) -> bool:
        """Return whether *one of them* is at `i`."""
        return self._words[i : i + 2] == ("one", "of") and self._after_of(i + 1) > i + 1

    def exclusion(self, i: int) -> int:
        """Return the number of words before an exception at `i` (except, but not), or 0."""
        length = self._g.match("exclude", self._words, i)
        is_any = any(self._g.is_a(self._words[i - 1], kind) for kind in ("anything", "everyone"))
        if not length and is_any and self._words[i : i + 1] == ("but",):
            return 1  # take anything but the milk
        is_clause = self._words[i + length : i + length + 1] == ("that",)
        is_clause = is_clause and not (self._t.is_translated and self._t.word(i + length) != "che")  # quella
        return 0 if is_clause and not self._is_determiner(i + length, 1) else length  # except that it is red
